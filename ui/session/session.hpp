#pragma once

#include <atomic>
#include <condition_variable>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "ui/session/frame_cache.hpp"
#include "ui/session/run_track.hpp"
#include "ui/session/session_view.hpp"

namespace stillpoint {

struct SessionOptions {
  bool baseline = true;    ///< method `none` runs beside any other method
  bool keep_times = true;  ///< false: stage times stay 0, so that images repeat byte for byte
};

/// A sequence being looked at: runs odometry over it as far as asked, keeps what each frame left, and makes
/// the snapshots that panels draw. What it shows at frame N equals a batch run's record N, whichever way it
/// was come to.
///
/// Used from one thread: either go_to() and view() alone, or, after start(), the requests and view(). The
/// work is then done on a thread of its own.
class Session {
 public:
  /// Shows the first frame, not yet processed.
  Session(std::shared_ptr<const FrameSource> source, const Config& config,
          const SessionOptions& options = {});
  /// Waits for the frame at hand.
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  [[nodiscard]] const FrameSource& source() const { return *source_; }

  /// What is shown. Never null; another object after each change.
  [[nodiscard]] std::shared_ptr<const SessionView> view() const;

  // Without a worker.

  /// Processes as far as `frame` and shows it; a frame beyond the ends means the nearest one there is.
  /// @param on_frame told the record of each frame newly processed
  void go_to(int frame, const std::function<void(const FrameRecord&)>& on_frame = {});

  /// Works out FrameView::before of the frame shown, where it is not at hand. Not beside a worker.
  void complete();

  /// A record of the session's run with all its features. Not beside a worker.
  [[nodiscard]] FrameRecord record(int index) const { return run_->record(index); }

  // With a worker.

  /// Starts it. `on_change` is called from it whenever view() has changed.
  void start(std::function<void()> on_change = {});
  void request_frame(int frame);  ///< as go_to(), soon
  void request_play(bool play);   ///< frame after frame from the one shown on
  void request_speed(double frames_per_second);
  /// Whether the frame before the one shown is wanted as well: made when there is nothing else to do.
  void request_comparison(bool wanted);
  /// Another config: the run begins anew and goes on to the frame shown.
  void request_config(const Config& config);

 private:
  struct Requests {
    std::optional<int> frame;
    std::optional<bool> play;
    std::optional<Config> config;
  };
  /// What a frame's motion stage made and a record does not hold.
  struct Extras {
    int index = 0;
    MotionTrace motion{};
    DepthMotionTrace depth_motion{};
    cv::Mat mask{};
  };

  void restart(const Config& config);
  void process_one();
  void show(int frame);
  void publish();
  [[nodiscard]] FrameView frame_view(int index);
  [[nodiscard]] std::shared_ptr<const FrameView> held_view(int index,
                                                           std::shared_ptr<const FrameView> before);
  [[nodiscard]] bool lacks_before() const;
  [[nodiscard]] Extras extras_of(int index);
  void keep(Extras extras);
  [[nodiscard]] RunTrack::ReadFrame reader();

  void work(const std::stop_token& stop);
  [[nodiscard]] bool take_requests();
  void work_step();

  std::shared_ptr<const FrameSource> source_;
  SessionOptions options_;
  std::unique_ptr<RunTrack> run_, baseline_;
  FrameCache frames_;
  std::deque<Extras> extras_;  // of the frames processed or replayed last
  std::shared_ptr<const FrameView> current_;
  std::shared_ptr<const RunView> run_view_, baseline_view_;
  int run_viewed_ = -1;  // frames run_view_ knows
  std::uint64_t revision_ = 0;
  int target_ = 0;  // the frame wanted
  bool playing_ = false;
  std::string message_;

  mutable std::mutex mutex_;  // guards what follows
  std::condition_variable_any asked_;
  Requests requests_;
  std::shared_ptr<const SessionView> view_;
  std::function<void()> on_change_;
  std::atomic<double> frames_per_second_ = 30.0;
  std::atomic<bool> compares_ = false;  // FrameView::before is wanted
  std::jthread worker_;                 // last: it ends before what it works with
};

}  // namespace stillpoint
