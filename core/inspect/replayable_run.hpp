#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <vector>

#include "core/byte_store.hpp"
#include "core/inspect/frame_view.hpp"
#include "core/inspect/motion_replay.hpp"
#include "core/inspect/run_view.hpp"
#include "core/odometry/odometry.hpp"
#include "core/run/records_file.hpp"
#include "core/run/run_hash.hpp"
#include "core/run/run_sequence.hpp"
#include "core/run/tracked_poses.hpp"
#include "core/sequence/source.hpp"

namespace stillpoint {

/// How many frames back the frames lie, at most, that a method compares one with.
[[nodiscard]] int frames_compared_back(const Camera& camera, const Config& config);

/// How much a ReplayableRun keeps.
struct ReplayableRunOptions {
  int checkpoint_every = 25;  ///< frames between copies of the odometry; doubled when there are too many
  int max_checkpoints = 20;
  bool keep_features = true;  ///< of the records: most of their size
  bool keep_times = true;     ///< of the records; without them two runs give the same bytes
  bool score_masks = true;    ///< masks are compared with the true ones, where the sequence has these
};

/// One method's way through a sequence, as far as it has been processed: records, and copies of the odometry
/// from which any earlier frame can be processed again exactly as it was.
class ReplayableRun {
 public:
  using ReadFrame = std::function<Frame(int)>;

  ReplayableRun(const FrameSource& source, const Config& config, const ReplayableRunOptions& options = {});

  /// A finished run: its frames count as processed though no odometry has seen them here yet. One that is to
  /// see them does so first (catch_up), and then gives the same bytes again.
  ReplayableRun(const FrameSource& source, std::shared_ptr<const RecordedRun> recorded,
                const ReplayableRunOptions& options = {});

  /// Processes frame `processed()`, which must be in the sequence.
  /// @returns images of the motion stage; its record has gone into records()
  FrameResult process_next(const ReadFrame& read);

  /// Processes a frame that was processed before once more, from the nearest checkpoint on.
  [[nodiscard]] FrameResult replay(int index, const ReadFrame& read) const;

  /// Odometry on its way to where it stood before a frame.
  struct Rewound {
    Odometry odometry;
    int next = 0;  ///< frame it processes next
  };
  /// The odometry of the nearest checkpoint at or before a frame that was processed.
  [[nodiscard]] Rewound rewound(int index, const ReadFrame& read) const;
  /// The frame that checkpoint stands before.
  [[nodiscard]] int checkpoint_before(int index) const;

  /// Whether the motion stage of a frame can be had again from records alone, which is far quicker than
  /// replay(): where a copy of the method's state stands before it, or the method keeps none.
  [[nodiscard]] bool can_repeat_motion(int index) const;
  /// Earlier frames that motion_before(index) reads.
  [[nodiscard]] std::set<int> frames_to_repeat(int index) const;
  /// The motion stage as it stands before a frame. @pre can_repeat_motion(index)
  [[nodiscard]] MotionReplay motion_before(int index, const ReadFrame& read) const;
  /// What is true of a frame, for a method that asks for it.
  [[nodiscard]] cv::Mat true_mask_used(const Config& config, int index) const {
    return needs_true_mask(config) ? source_->truth(index).moving : cv::Mat();
  }

  /// Processes frame `index` with an odometry that stands before it, and changes nothing here.
  [[nodiscard]] FrameResult process(Odometry& odometry, int index, const ReadFrame& read) const {
    return process(odometry, read(index), true_mask_used(odometry.config(), index));
  }

  /// The odometry as it stood before frame `index`, which was processed.
  [[nodiscard]] Odometry before(int index, const ReadFrame& read) const;

  /// Earlier frames that before(index) looks at beside those it processes.
  [[nodiscard]] std::set<int> frames_to_restore(int index) const;

  /// `count` frames before frame `index`, fewer at the start: what Odometry::continued_with wants.
  [[nodiscard]] std::vector<PastFrame> frames_before(int index, int count, const ReadFrame& read) const;

  /// Another run that has this one's frames up to `from`, and goes on with another config from there; from
  /// the first frame on where that cannot be (Odometry::continued_with).
  [[nodiscard]] ReplayableRun branch(int from, const Config& config, const ReadFrame& read) const;

  [[nodiscard]] int processed() const { return static_cast<int>(records_.size()); }
  [[nodiscard]] int begins_at() const { return begins_at_; }  ///< first frame that is its own
  /// All records, without their features: those are most of a record's size.
  [[nodiscard]] const FrameRecords& records() const { return records_; }
  /// One a record: its mask against the true one, where that is known and was to be scored.
  [[nodiscard]] const ScoreList& scores() const { return scores_; }
  /// Its frames as figures are asked of them that need no evaluation; refers to this run.
  [[nodiscard]] MeasuredFrames measured() const;
  /// A record with its features, where they are kept.
  [[nodiscard]] FrameRecord record(int index) const;
  [[nodiscard]] std::vector<SavedKeyframe> keyframes() const;
  /// Of the map, and after them those that left it because they moved.
  [[nodiscard]] std::vector<SavedPoint> points() const;

  /// What another program's run is called, of which nothing can be computed again here; empty = it is ours.
  [[nodiscard]] std::string outside() const { return recorded_ ? recorded_->outside : std::string(); }
  /// What it is called.
  [[nodiscard]] std::string name() const;
  /// Frames that odometry has seen here: all that are processed, but for a recorded run.
  [[nodiscard]] int seen() const { return seen_; }
  /// Shows odometry the next of a recorded run's frames that it has not seen.
  void catch_up_one(const ReadFrame& read);
  /// What a recorded run removed from a frame; empty where nothing was.
  [[nodiscard]] cv::Mat recorded_mask(int index) const;
  [[nodiscard]] const Config& config() const { return odometry_.config(); }
  [[nodiscard]] bool keeps_times() const { return options_.keep_times; }
  [[nodiscard]] int checkpoints() const { return static_cast<int>(checkpoints_.size()); }
  /// Bytes of memory that lists of one thing a frame hold: what grows with a sequence.
  [[nodiscard]] std::size_t held_bytes() const {
    return records_.held_bytes() + scores_.held_bytes() + poses_.held_bytes() + features_.held_bytes();
  }
  [[nodiscard]] std::string hash() const { return hash_.hex(); }  ///< run_hash of records()

  /// The run for panels: records without their features, trajectory and evaluation so far.
  [[nodiscard]] RunView view() const;

 private:
  [[nodiscard]] bool needs_true_mask(const Config& config) const;
  [[nodiscard]] FrameResult process(Odometry& odometry, const Frame& frame, const cv::Mat& known_mask) const;
  void keep_checkpoint();
  void keep_motion_state();
  void keep_features(const std::vector<FeatureRecord>& features);
  [[nodiscard]] bool is_as_recorded() const;

  const FrameSource* source_;
  ReplayableRunOptions options_;
  std::shared_ptr<const RecordedRun> recorded_;  // null for a run that began here
  Odometry odometry_;
  int seen_ = 0;  // frames odometry_ has processed
  int begins_at_ = 0;
  std::shared_ptr<ByteStore> store_ = ByteStore::make();
  FrameRecords records_;               // without features, put by but for their outlines
  ChunkedList<StoredBytes> features_;  // … which are here; empty where they are not kept, …
  std::shared_ptr<const FrameDetails> recorded_features_;  // … or here, of the first …
  int recorded_frames_ = 0;                                // … records
  ScoreList scores_;                                       // one a record, put by
  TrackedPoses poses_;                                     // of the records, put by
  std::shared_ptr<FigureColumns> columns_;                 // of the records, as they were asked for
  std::map<int, Odometry> checkpoints_;                    // by the frame they process next
  std::map<int, MotionStage> motion_states_;               // without images, by the frame they judge next
  int motion_state_every_;  // frames between them; doubled when there are too many
  RunHash hash_;
};

}  // namespace stillpoint
