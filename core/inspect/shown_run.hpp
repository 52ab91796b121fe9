#pragma once

#include <deque>
#include <memory>
#include <set>

#include "core/inspect/frame_cache.hpp"
#include "core/inspect/replayable_run.hpp"
#include "core/sequence/prefetch.hpp"

namespace stillpoint {

/// A frame's view and the record it points to, kept alive together.
[[nodiscard]] std::shared_ptr<const FrameView> hold(FrameView view, std::optional<FrameRecord> record);

/// A run whose frames can be looked at, in whatever order: images of the frames processed last are at hand,
/// those of others are computed again.
class ShownRun {
 public:
  ShownRun(const FrameSource& source, FrameCache& frames, ReplayableRun track)
      : source_(&source), frames_(&frames), track_(std::move(track)) {}

  /// Processes the next frame. @param frame that frame, read
  void process(const Frame& frame);

  /// Shows odometry the next of a finished run's frames that it has not seen.
  void catch_up_one() { track_.catch_up_one(reader()); }

  [[nodiscard]] const ReplayableRun& track() const { return track_; }

  /// The frame with all its images and, where it was processed, its record and those right before.
  /// @param before becomes FrameView::before
  [[nodiscard]] std::shared_ptr<const FrameView> frame_view(
      int index, std::shared_ptr<const FrameView> before = nullptr);

  /// The images and the record of a frame that was processed, without stages: quick to have.
  [[nodiscard]] std::shared_ptr<const FrameView> record_view(int index);

  /// The image of any frame, nothing else of it: FrameView::image_alone.
  [[nodiscard]] std::shared_ptr<const FrameView> image_view(int index);
  /// Whether frame_view() has little to do: what the frame's motion stage made is kept.
  [[nodiscard]] bool has_at_hand(int index) const;

  /// The run for panels; the same object until another frame was processed.
  [[nodiscard]] std::shared_ptr<const RunView> run_view();

  /// One frame once more as it would be under another config, from the state before it. What it is compared
  /// with is kept, so that one frame under many configs costs little more than that frame's work.
  [[nodiscard]] std::shared_ptr<const FrameView> preview(int index, const Config& config);

  /// One step towards the state that preview() begins with, a frame's work.
  /// @returns whether it is at hand
  bool prepare_preview(int index);

  /// The same frame's motion stages alone, at once: under the run's own poses, with its own matches.
  /// @returns null where these do not lead to them
  [[nodiscard]] std::shared_ptr<const FrameView> motion_preview(int index, const Config& config);

  /// Another method's stages are laid beside the run's own in every frame view made from now on.
  /// @param method its name; empty for none
  void lay_beside(const std::string& method) { beside_ = method; }

  [[nodiscard]] ReplayableRun::ReadFrame reader() const {
    return [this](int index) { return frames_->read(index); };
  }

 private:
  /// What a frame's motion stage made and a record does not hold.
  struct Extras {
    int index = 0;
    MotionResult motion{};
    cv::Mat mask{};
    std::shared_ptr<const EngineTrace> engine{};
    std::string note{};  ///< why there are no stages; empty when there are
  };

  [[nodiscard]] FrameView images_of(int index, const Config& config, Extras extras);
  [[nodiscard]] Extras extras_of(int index);
  [[nodiscard]] std::shared_ptr<const StageLog> stages_beside(int index);
  /// Processes a frame that was processed before, from the state before it.
  [[nodiscard]] FrameResult process_again(int index, const Config& config);
  [[nodiscard]] bool set_out_for(int index);
  [[nodiscard]] bool is_own(int index) const {
    return index >= track_.begins_at() && index < track_.processed();
  }
  /// Nothing where the frame has not been processed.
  [[nodiscard]] std::optional<FrameRecord> record_without_features(int index) const;
  [[nodiscard]] const MotionReplay& motion_before(int index);
  [[nodiscard]] std::optional<MotionAgain> motion_again(int index, const Config& config);
  [[nodiscard]] std::shared_ptr<const FrameView> with_history(FrameView view,
                                                              std::optional<FrameRecord> record) const;
  void keep(Extras extras);

  const FrameSource* source_;
  FrameCache* frames_;
  ReplayableRun track_;
  std::string beside_;         // method whose stages are laid beside; empty = none
  std::deque<Extras> extras_;  // of the frames processed or replayed last
  std::shared_ptr<const RunView> view_;
  /// The state before a frame that is processed again, or the way there.
  struct Before {
    int index = 0;
    ReplayableRun::Rewound way;
    std::unique_ptr<Prefetcher> frames{};  // null once it is there
  };
  std::optional<std::pair<int, std::set<int>>> to_read_;       // before one can set out for a frame
  std::optional<Before> before_;                               // of the frame processed again last
  std::optional<std::pair<int, MotionReplay>> motion_before_;  // … whose motion alone was found again
};

}  // namespace stillpoint
