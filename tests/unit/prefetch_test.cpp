#include "core/sequence/prefetch.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <stdexcept>

namespace stillpoint {
namespace {

/// A source whose frames take their time, unevenly, and which knows how far ahead it was read.
class SlowSource final : public FrameSource {
 public:
  explicit SlowSource(int size) : size_(size) {}
  [[nodiscard]] const std::string& name() const override { return name_; }
  [[nodiscard]] const Camera& camera() const override { return camera_; }
  [[nodiscard]] int size() const override { return size_; }
  [[nodiscard]] double timestamp(int index) const override { return index; }
  [[nodiscard]] Frame read(int index) const override {
    std::this_thread::sleep_for(std::chrono::milliseconds(index % 3));
    ++reads;
    if (index == throws_at) throw std::runtime_error("broken on purpose");
    Frame frame;
    frame.index = index;
    frame.gray = cv::Mat(2, 2, CV_8UC1, cv::Scalar(index % 256));
    return frame;
  }
  [[nodiscard]] FrameTruth truth(int) const override { return {}; }
  [[nodiscard]] const Trajectory& ground_truth() const override { return none_; }
  [[nodiscard]] bool has_depth() const override { return false; }
  [[nodiscard]] bool has_masks() const override { return false; }
  [[nodiscard]] const std::vector<std::string>& warnings() const override { return warnings_; }

  mutable std::atomic<int> reads{0};
  int throws_at = -1;

 private:
  int size_;
  std::string name_ = "slow";
  Camera camera_;
  Trajectory none_;
  std::vector<std::string> warnings_;
};

TEST(Prefetcher, DeliversInOrderWhateverTheWorkers) {
  const SlowSource source(40);
  for (const int workers : {1, 3}) {
    Prefetcher prefetcher(source, 0, -1, workers, 5);
    for (int i = 0; i < 40; ++i) {
      ASSERT_TRUE(prefetcher.has_next());
      const Frame frame = prefetcher.next();
      ASSERT_EQ(frame.index, i);
      ASSERT_EQ(frame.gray.at<uchar>(0, 0), i);
    }
    EXPECT_FALSE(prefetcher.has_next());
    EXPECT_FALSE(prefetcher.next().readable());
  }
}

TEST(Prefetcher, ReadsARangeAndNoFartherThanItsWindow) {
  const SlowSource source(100);
  {
    Prefetcher prefetcher(source, 10, 90, 2, 4);
    EXPECT_EQ(prefetcher.next().index, 10);
    EXPECT_EQ(prefetcher.next().index, 11);
  }
  EXPECT_LE(source.reads, 2 + 4);
}

TEST(Prefetcher, StopsWithoutBeingRead) {
  const SlowSource source(5), nothing(0);
  { const Prefetcher prefetcher(source, 0, -1, 4, 8); }
  Prefetcher empty(nothing);
  EXPECT_FALSE(empty.has_next());
}

TEST(Prefetcher, GivesAnUnreadableFrameWhereTheSourceThrows) {
  SlowSource source(3);
  source.throws_at = 1;
  Prefetcher prefetcher(source);
  EXPECT_TRUE(prefetcher.next().readable());
  const Frame broken = prefetcher.next();
  EXPECT_FALSE(broken.readable());
  EXPECT_EQ(broken.index, 1);
  EXPECT_EQ(broken.problem, "frame 1 cannot be read: broken on purpose");
  EXPECT_TRUE(prefetcher.next().readable());
}

}  // namespace
}  // namespace stillpoint
