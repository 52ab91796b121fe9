#include "core/sequence/video/video_frames.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/error.hpp"

namespace stillpoint {
namespace {

// Bytes of decoded frames: 145 of 640 x 480, to step back among.
constexpr std::size_t kKeptBytes = std::size_t{128} << 20;
constexpr std::size_t kFewestKept = 8;     // frames, however large
constexpr std::size_t kMostHeldBack = 16;  // frames, of H.264 and H.265
constexpr double kUsualRate = 30.0;        // Hz, where the file names none that can be

double usual_step(const VideoReader& reader) {
  const double rate = reader.frame_rate();
  return rate >= 1.0 && rate <= 1000.0 ? 1.0 / rate : 1.0 / kUsualRate;
}

}  // namespace

VideoFrames::VideoFrames(std::string path, int most, const std::function<void(double)>& progress)
    : path_(std::move(path)), reader_(media_module().video_reader()) {
  if (!reader_->open(path_)) throw InputError(fmt::format("{}: is no video that can be decoded", path_));
  const double step = usual_step(*reader_);
  const int by_head = reader_->frames_by_head();
  while ((most == 0 || static_cast<int>(stamps_.size()) < most) && reader_->next()) {
    stamps_.push_back(reader_->seconds());
    if (progress && by_head > 0 && stamps_.size() % 32 == 0)
      progress(std::min(
          1.0, static_cast<double>(stamps_.size()) / (most > 0 ? std::min(most, by_head) : by_head)));
  }
  next_ = static_cast<int>(stamps_.size());
  if (stamps_.empty()) throw InputError(fmt::format("{}: none of its frames can be decoded", path_));
  const int mended = settle(step);
  if (mended > 0)
    warnings_.push_back(fmt::format(
        "{}: {} of its {} frames are stamped no later than the one before; they were taken {:.1f} ms later",
        path_, mended, stamps_.size(), 1000.0 * step));
  const bool all = most == 0 || static_cast<int>(stamps_.size()) < most;
  // Heads count a frame or two that an encoder left out.
  constexpr int kSlack = 2;
  if (all && by_head > static_cast<int>(stamps_.size()) + kSlack)
    warnings_.push_back(
        fmt::format("{}: is cut off or damaged: its head says {} frames, and {} can be decoded", path_,
                    by_head, stamps_.size()));
}

int VideoFrames::settle(double step) {
  // The frames that a decoder held back until the file's end come without a stamp, as 0.
  std::size_t stamped = stamps_.size();
  while (stamped > 1 && stamps_[stamped - 1] == 0.0) --stamped;
  if (stamps_.size() - stamped > kMostHeldBack) stamped = stamps_.size();
  if (!std::isfinite(stamps_.front())) stamps_.front() = 0.0;
  int mended = 0;
  double last_step = step;
  for (std::size_t i = 1; i < stamps_.size(); ++i) {
    const double later = stamps_[i] - stamps_[i - 1];
    if (std::isfinite(later) && later > 0) {
      last_step = later;
      continue;
    }
    stamps_[i] = stamps_[i - 1] + (i < stamped ? step : last_step);
    mended += i < stamped ? 1 : 0;
  }
  return mended;
}

void VideoFrames::keep(int index, const cv::Mat& image) const {
  const std::size_t bytes = std::max<std::size_t>(1, image.total() * image.elemSize());
  const std::size_t count = std::max(kFewestKept, kKeptBytes / bytes);
  while (kept_.size() >= count) kept_.pop_front();
  kept_.push_back({index, image});
}

cv::Mat VideoFrames::image(int index) const {
  const std::lock_guard lock(mutex_);
  const auto kept =
      std::find_if(kept_.begin(), kept_.end(), [index](const Kept& frame) { return frame.index == index; });
  if (kept != kept_.end()) return kept->image.clone();
  if (index < next_) {
    reader_ = media_module().video_reader();
    next_ = 0;
    kept_.clear();
    if (!reader_->open(path_)) return {};
  }
  // What lies just before the frame may be asked for next: another thread's, or a step back.
  const int from = index - static_cast<int>(kFewestKept) + 1;
  for (; next_ <= index; ++next_) {
    if (!reader_->next()) {
      next_ = static_cast<int>(stamps_.size());  // it is opened anew for the next frame
      return {};
    }
    if (next_ >= from) keep(next_, reader_->image());
  }
  return kept_.back().image.clone();
}

}  // namespace stillpoint
