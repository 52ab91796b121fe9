#pragma once

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <condition_variable>
#include <memory>
#include <mutex>

#include "core/run/record_codec.hpp"
#include "core/run/run_report.hpp"
#include "tests/cli/small_sequence.hpp"
#include "ui/session/session.hpp"

namespace stillpoint {

inline constexpr int kDebugFrames = 12;

/// A session with its worker, whose views can be waited for.
class StartedSession {
 public:
  explicit StartedSession(std::unique_ptr<Session> session) : session_(std::move(session)) {
    session_->start([this] {
      const std::lock_guard lock(mutex_);
      changed_.notify_all();
    });
  }
  Session* operator->() { return session_.get(); }

  /// Whether it comes true within two minutes.
  template <typename Condition>
  bool wait_for(Condition holds) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, std::chrono::seconds(120), [&] { return holds(*session_->view()); });
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::unique_ptr<Session> session_;  // last: its worker tells of changes until it is gone
};

/// A session over a small folder, asked without a worker unless a test starts one.
class SessionDebug : public ::testing::Test {
 protected:
  SessionDebug() {
    config_.run.method = "paper";
    config_.features.count = 400;
  }
  [[nodiscard]] std::unique_ptr<Session> session(bool baseline = false) const {
    return std::make_unique<Session>(source_, config_, SessionOptions{.baseline = baseline});
  }
  [[nodiscard]] RunResult batch(const Config& config, int frames) const {
    RunOptions options;
    options.count = frames;
    return run_sequence(*source_, config, options);
  }
  static const DebugView& debug(const Session& session) {
    static std::shared_ptr<const SessionView> view;
    view = session.view();
    return view->debug;
  }

  SmallSequence folder_{kDebugFrames};
  std::shared_ptr<const FrameSource> source_ = open_sequence(folder_.path());
  Config config_;
};

/// All that a record holds, times left out, as bytes.
inline std::vector<std::uint8_t> bytes_of(FrameRecord record) {
  record.ms = {};
  ByteStreamWriter bytes;
  write_record(bytes, record);
  return bytes.bytes();
}

/// A run that can be looked at, without a session about it.
struct ShownRunFixture {
  ShownRunFixture(const FrameSource& source, const Config& config)
      : frames(source), run(source, frames, ReplayableRun(source, config)) {}
  FrameCache frames;
  ShownRun run;
};

/// True masks, one a frame: a square that stands for what is dynamic.
inline void write_masks(const SmallSequence& sequence) {
  std::string list;
  cv::Mat mask = cv::Mat::zeros(SmallSequence::kHeight, SmallSequence::kWidth, CV_8UC1);
  mask(cv::Rect(40, 40, 60, 60)).setTo(255);
  for (int i = 0; i < kDebugFrames; ++i) {
    const std::string file = fmt::format("mask/{}.png", i);
    sequence.folder.write(file, mask);
    list += fmt::format("{:.4f} {}\n", SmallSequence::stamp(i), file);
  }
  sequence.folder.write("mask.txt", list);
}

}  // namespace stillpoint
