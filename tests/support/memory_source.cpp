#include "tests/support/memory_source.hpp"

#include <algorithm>
#include <opencv2/imgproc.hpp>

namespace stillpoint {

MemorySource::MemorySource(const FrameSource& source, int frames, const cv::Size& size)
    : source_(source), camera_(source.camera().scaled_to(size.width, size.height)) {
  for (int i = 0; i < std::min(frames, source.size()); ++i) {
    Frame frame = source.read(i);
    frame.colour.release();
    if (frame.readable() && frame.gray.size() != size) {
      cv::resize(frame.gray, frame.gray, size, 0, 0,
                 size.width < frame.gray.cols ? cv::INTER_AREA : cv::INTER_LINEAR);
      if (frame.has_depth()) cv::resize(frame.depth, frame.depth, size, 0, 0, cv::INTER_NEAREST);
    }
    frames_.push_back(std::move(frame));
  }
}

}  // namespace stillpoint
