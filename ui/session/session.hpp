#pragma once

#include <atomic>
#include <chrono>
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

#include "core/inspect/breakpoint_set.hpp"
#include "core/inspect/frame_cache.hpp"
#include "core/inspect/shown_run.hpp"
#include "core/inspect/sidecar.hpp"
#include "ui/session/export_job.hpp"
#include "ui/session/session_view.hpp"

namespace stillpoint {

struct SessionOptions {
  bool baseline = true;    ///< the baseline method runs beside any other
  bool keep_times = true;  ///< false: stage times stay 0, so that images repeat byte for byte
  std::shared_ptr<const RecordedRun> recorded{};             ///< a finished run to begin with
  std::shared_ptr<const RecordedRun> recorded_baseline{};    ///< … and one to stand beside it
  std::vector<std::shared_ptr<const RecordedRun>> beside{};  ///< finished runs that stand beside as ghosts
  std::string no_images{};  ///< why the source has no images, one sentence: nothing can be processed then
  bool catch_up = false;    ///< go_to() lets odometry see a recorded run's frames as far as the one shown
  int runs_wait = 30;  ///< while a worker adds frames, runs stay as shown so many times as long as making
                       ///< them anew took: it takes a thirtieth of the time at most
  std::optional<SidecarPlaces> sidecar{};  ///< where bookmarks and the like are kept; nothing = they are not
};

/// A sequence being looked at: runs odometry over it as far as asked, keeps what each frame left, and makes
/// the snapshots that panels draw. What it shows at frame N equals a batch run's record N, whichever way it
/// was come to. Beside it ghost runs with other configs are kept level with it.
///
/// Used from one thread. Before start() requests are carried out at once; after it, on a thread of its own,
/// soon.
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
  [[nodiscard]] FrameRecord record(int index) const { return run_->track().record(index); }

  /// What panels ask for. Of frames to go to and of previews, only the newest counts. What goes wrong is told
  /// by SessionView::message.
  void request(SessionRequest wanted);

  // With a worker.

  /// Starts it. `on_change` is called from it whenever view() has changed.
  void start(std::function<void()> on_change = {});
  void request_frame(int frame) { request(request::GoTo{frame}); }
  void request_step(int by) { request(request::Step{by}); }
  void request_play(bool play) { request(request::Play{play}); }  ///< from the frame shown on
  void request_speed(double frames_per_second);
  /// Nothing is asked for and nothing is being worked on: view() stays as it is. False without a worker.
  [[nodiscard]] bool idle() const;
  /// Whether the frame before the one shown is wanted as well: made when there is nothing else to do.
  void request_comparison(bool wanted);
  /// Whether SessionView::baseline_frame is wanted: made when there is nothing else to do, and from then on
  /// with each frame shown. With or without a worker.
  void request_baseline(bool wanted);
  /// Another config: the run begins anew and goes on to the frame shown.
  void request_config(const Config& config) { request(request::RunAll{config}); }

 private:
  /// A run beside the session's own.
  struct Ghost {
    std::string name;
    std::unique_ptr<ShownRun> run;
    std::shared_ptr<const RunView> run_view{};   // as published last
    std::size_t look = 0;                        // keeps its colour when others go
    std::shared_ptr<const FrameView> current{};  // of the frame shown; null while it has not come so far
    std::optional<int> diverged{};
    int compared = 0;                          // frames
    std::shared_ptr<const FrameView> other{};  // that stands beside `current`
  };

  void restart(const Config& config);
  void open_recorded();
  [[nodiscard]] bool stages_are_missing() const;
  void catch_up();
  void refuse_without_images(const char* what) const;
  void process_one();
  void show(int frame);
  void show_image_first();
  void choose_others();
  [[nodiscard]] std::shared_ptr<const FrameView> other_of(ShownRun& run, const FrameView* current) const;
  [[nodiscard]] bool lacks_baseline() const;
  void show_baseline();
  void publish();
  [[nodiscard]] bool runs_may_wait() const;
  [[nodiscard]] bool renew_runs();
  [[nodiscard]] DebugView debug_view();
  [[nodiscard]] bool lacks_before() const;

  // Requests, one by one.
  void carry_out(const SessionRequest& wanted);
  void carry_out(const request::GoTo& wanted);
  void carry_out(const request::Step& wanted);
  void carry_out(const request::Play& wanted);
  void carry_out(const request::Bookmarks& wanted);
  void carry_out(const request::Pins& wanted);
  void carry_out(const request::Drawn& wanted);
  void carry_out(const request::WriteTruth& wanted);
  void carry_out(const request::Breakpoints& wanted);
  void carry_out(const request::Span& wanted);
  void carry_out(const request::Preview& wanted);
  void carry_out(const request::RunAll& wanted);
  void carry_out(const request::AddGhost& wanted);
  void carry_out(const request::RemoveGhost& wanted);
  void carry_out(const request::ExportFrames& wanted);
  void carry_out(const request::ExportSession& wanted);
  void carry_out(const request::CheckSequence& wanted);
  void carry_out(const request::Sweep& wanted);
  void carry_out(const request::StopSweep& wanted);
  void carry_out(const request::StopExport& wanted);
  void carry_out(const request::StagesBeside& wanted);
  void carry_out(const request::StandBeside& wanted);
  void carry_out(const request::Undo& wanted);
  void carry_out(const request::Redo& wanted);
  void carry_out(const request::SavePreset& wanted);
  void write_beside(const std::string& folder, ExportJob::Work work);

  void work(const std::stop_token& stop);
  void attempt(const std::function<void()>& work);
  [[nodiscard]] bool take_requests();
  [[nodiscard]] bool at_rest() const;
  [[nodiscard]] int next_while_playing() const;
  void stop_playing_where_wanted();
  /// Waits until something is asked for or, with `until_comparison`, until the frame before is.
  void rest(const std::stop_token& stop, bool until_comparison);
  void work_step();
  void settle();
  [[nodiscard]] bool take_news();
  // What is done when nothing else is asked for, a frame at a time.
  [[nodiscard]] bool has_background() const;
  void background_step();
  void preview_step();
  void advance(Ghost& ghost);
  void compare(Ghost& ghost);
  void add(Ghost ghost);
  void begin_waiting_ghosts();
  void open_beside(const std::shared_ptr<const RecordedRun>& recorded);
  void update_breakpoints();
  void open_sidecar();
  [[nodiscard]] Marks marks() const;
  void save_marks();
  void set_marks(Marks marks);
  void remember(Marks before, std::size_t request);

  std::shared_ptr<const FrameSource> source_;
  SessionOptions options_;
  FrameCache frames_;
  std::unique_ptr<ShownRun> run_;
  std::unique_ptr<ShownRun> baseline_;
  BesideFrame baseline_frame_;  // of the frame shown, where it is wanted
  std::vector<Ghost> ghosts_;
  std::shared_ptr<const FrameView> current_;
  std::shared_ptr<const FrameView> whole_;  // shown before the image of the one that is worked out; else null
  std::shared_ptr<const RunView> run_view_, baseline_view_;
  std::chrono::steady_clock::time_point runs_due_{};  // when they are to be made anew
  std::uint64_t revision_ = 0;
  int target_ = 0;  // the frame wanted
  int wanted_ = 0;  // frames to have processed, once there is time
  bool playing_ = false;
  bool frame_asked_ = false;  // among the requests being carried out
  std::string beside_;        // method whose stages are laid beside; empty = none
  std::string message_;
  DebugView debug_;  // without breakpoints and ghosts
  BreakpointSet breakpoints_;
  bool breakpoints_due_ = false;
  bool preview_due_ = false;         // the frame shown is to be worked out under debug_.preview_config
  bool motion_preview_due_ = false;  // … and first its motion stages
  std::chrono::steady_clock::time_point preview_asked_{};  // when it was asked for last
  bool sidecar_due_ = false;
  std::optional<Sidecar> sidecar_;
  std::vector<Marks> undo_, redo_;                     // as they were, the last at the end
  std::size_t marked_by_ = 0;                          // the kind of request that changed marks last, …
  std::chrono::steady_clock::time_point marked_at_{};  // … and when
  std::atomic<bool> masks_written_ = false;            // true masks, into the sequence
  bool looked_over_ = false;                           // check_frames() has been asked
  std::unique_ptr<ExportJob> export_;                  // the worker's; null while nothing is being written

  mutable std::mutex mutex_;  // guards what follows
  std::condition_variable_any asked_;
  std::deque<SessionRequest> requests_;
  bool resting_ = false;
  std::shared_ptr<const SessionView> view_;
  std::function<void()> on_change_;
  std::atomic<double> frames_per_second_ = 30.0;
  std::atomic<bool> compares_ = false;        // FrameView::before is wanted
  std::atomic<bool> shows_baseline_ = false;  // SessionView::baseline_frame is
  std::atomic<bool> news_ = false;            // of what goes on beside the session
  std::atomic<bool> exporting_ = false, checking_ = false;
  std::optional<CheckView> checked_;  // what the last questioning found
  std::vector<SweepPoint> swept_;     // not yet taken into debug_.sweep
  std::string sweep_problem_;
  std::atomic<bool> sweeping_ = false, stop_sweep_ = false;
  std::jthread sweeper_;  // ends before what it works with
  std::jthread checker_;  // ends before what it works with
  std::jthread worker_;   // last: it ends before what it works with
};

}  // namespace stillpoint
