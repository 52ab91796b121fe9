#include "core/sequence/fingerprint.hpp"

#include <cstring>

#include "core/hash.hpp"

namespace stillpoint {
namespace {

/// Whole words of each row; what is left of a row is filled up with zeros.
void add_image(Fingerprint& print, const cv::Mat& image) {
  print.add(image.rows);
  print.add(image.cols);
  const std::size_t bytes = static_cast<std::size_t>(image.cols) * image.elemSize();
  for (int y = 0; y < image.rows; ++y) {
    const uchar* row = image.ptr(y);
    for (std::size_t at = 0; at < bytes; at += sizeof(std::uint64_t)) {
      std::uint64_t word = 0;
      std::memcpy(&word, row + at, std::min(sizeof(word), bytes - at));
      print.add(word);
    }
  }
}

}  // namespace

std::string sequence_fingerprint(const FrameSource& source) {
  Fingerprint print;
  const int size = source.size();
  print.add(size);
  for (int i = 0; i < size; ++i) print.add(source.timestamp(i));
  for (const StampedPose& pose : source.ground_truth()) {
    print.add(pose.timestamp);
    for (int i = 0; i < 3; ++i) print.add(pose.world_from_camera.translation()[i]);
  }
  for (const int index : {0, size / 2, size - 1}) {
    if (index < 0 || index >= size) continue;
    const Frame frame = source.read(index);
    add_image(print, frame.gray);
    add_image(print, frame.depth);
  }
  return print.hex();
}

}  // namespace stillpoint
