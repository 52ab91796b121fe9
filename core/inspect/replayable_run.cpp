#include "core/inspect/replayable_run.hpp"

#include <algorithm>
#include <future>
#include <type_traits>
#include <utility>

#include "core/inspect/run_view.hpp"
#include "core/odometry/engines.hpp"
#include "core/run/frame_figures.hpp"
#include "core/run/frame_records.hpp"
#include "core/sequence/prefetch.hpp"

namespace stillpoint {
namespace {

// More than so many states, and every second one goes: memory stays bounded.
constexpr std::size_t kMostMotionStates = 2500;

}  // namespace

int frames_compared_back(const Camera& camera, const Config& config) {
  const bool directly = method_of(config).extends_odometry && config.direct.below_inliers > 0;
  return std::max(MotionStage(camera, config).frames_back(), directly ? config.direct.max_age : 0);
}

ReplayableRun::ReplayableRun(const FrameSource& source, const Config& config,
                             const ReplayableRunOptions& options)
    : source_(&source),
      options_(options),
      odometry_(source.camera(), config),
      records_(records_put_by(store_, Outlines::at_hand)),
      scores_(scores_put_by(store_)),
      poses_(poses_put_by(store_)),
      columns_(std::make_shared<FigureColumns>()),
      motion_state_every_(odometry_.motion().info().needs.checkpoint_every) {}

bool ReplayableRun::needs_true_mask(const Config& config) const {
  return (method_of(config).needs.true_mask || config.run.check_removal) && source_->has_masks();
}

FrameResult ReplayableRun::process(Odometry& odometry, const Frame& frame, const cv::Mat& known_mask) const {
  FrameResult result = odometry.process(frame, known_mask);
  if (!options_.keep_times) result.record.ms = {};
  return result;
}

void ReplayableRun::keep_motion_state() {
  const MotionNeeds& needs = odometry_.motion().info().needs;
  if (!needs.keeps_state || needs.matches) return;
  if (seen_ != begins_at_ && seen_ % motion_state_every_ != 0) return;
  motion_states_.emplace(seen_, odometry_.motion()).first->second.drop_images();
  if (motion_states_.size() <= kMostMotionStates) return;
  motion_state_every_ *= 2;
  std::erase_if(motion_states_, [this](const auto& kept) {
    return kept.first != begins_at_ && kept.first % motion_state_every_ != 0;
  });
}

bool ReplayableRun::can_repeat_motion(int index) const {
  const MotionNeeds& needs = odometry_.motion().info().needs;
  if (needs.matches || index > processed() || !outside().empty()) return false;
  if (!needs.keeps_state) return !needs.first_pose || index < processed();
  return index < seen_ && motion_states_.upper_bound(index) != motion_states_.begin();
}

std::set<int> ReplayableRun::frames_to_repeat(int index) const {
  const int prepared = MotionPreparer(source_->camera(), config()).frames_back();
  const auto after = motion_states_.upper_bound(index);
  const bool kept = after != motion_states_.begin();
  const int first = kept ? std::prev(after)->first : index;
  std::set<int> frames;
  if (kept) frames = std::prev(after)->second.images_wanted(first, index);
  for (int i = std::max(0, first - prepared); i < index; ++i) frames.insert(i);
  return frames;
}

MotionReplay ReplayableRun::motion_before(int index, const ReadFrame& read) const {
  const auto after = motion_states_.upper_bound(index);
  if (after == motion_states_.begin())
    return {source_->camera(), config(), MotionStage(source_->camera(), config()), index, index, read};
  const auto& [first, state] = *std::prev(after);
  MotionReplay replay(source_->camera(), config(), state, first, index, read);
  for (int i = first; i < index; ++i) {
    const FrameRecord record = records_[static_cast<std::size_t>(i)];
    (void)replay.repeat(read(i), &record, true_mask_used(config(), i));
  }
  return replay;
}

FrameResult ReplayableRun::process_next(const ReadFrame& read) {
  const int index = processed();
  while (seen_ < index) catch_up_one(read);
  if (index == begins_at_ || index % options_.checkpoint_every == 0) keep_checkpoint();
  keep_motion_state();
  const Frame frame = read(index);
  // The truth is read beside tracking; only who is told of it waits for it.
  const bool told = needs_true_mask(config());
  auto truth = std::async(told ? std::launch::deferred : std::launch::async, [this, told, index] {
    return told || (options_.score_masks && source_->has_masks()) ? source_->truth(index).moving : cv::Mat();
  });
  const cv::Mat known = told ? truth.get() : cv::Mat();
  FrameResult result = process(odometry_, frame, known);
  scores_.push_back(score_frame(result, told ? known : truth.get(), method_of(config()).judges_features));
  ++seen_;
  // What a batch run does after its last frame.
  if (index + 1 == source_->size()) odometry_.finish();
  hash_.add(result.record);
  keep_features(result.record.features);
  std::vector<FeatureRecord> features = std::move(result.record.features);
  result.record.features = {};
  // Of a finished run nobody asks for them before it goes on.
  if (is_as_recorded())
    for (const FrameRecord& record : records_) add_pose(record, poses_);
  add_pose(result.record, poses_);
  records_.push_back(result.record);
  result.record.features = std::move(features);
  return result;
}

FrameRecord ReplayableRun::record(int index) const {
  const auto row = static_cast<std::size_t>(index);
  FrameRecord record = records_[row];
  if (recorded_features_ && index < recorded_frames_) {
    record.features = recorded_features_->of(row).features;
    return record;
  }
  const StoredBytes features = features_[row];
  record.features.resize(features.size() / sizeof(FeatureRecord));
  features.read(record.features.data());
  return record;
}

void ReplayableRun::keep_features(const std::vector<FeatureRecord>& features) {
  static_assert(std::is_trivially_copyable_v<FeatureRecord>);
  features_.push_back(options_.keep_features
                          ? store_->put(features.data(), features.size() * sizeof(FeatureRecord))
                          : StoredBytes());
}

void ReplayableRun::keep_checkpoint() {
  odometry_.shelve_features(*store_);
  checkpoints_.emplace(seen_, odometry_).first->second.drop_images();
  if (static_cast<int>(checkpoints_.size()) <= options_.max_checkpoints) return;
  options_.checkpoint_every *= 2;
  std::erase_if(checkpoints_, [this](const auto& kept) {
    return kept.first != begins_at_ && kept.first % options_.checkpoint_every != 0;
  });
}

int ReplayableRun::checkpoint_before(int index) const {
  const auto after = checkpoints_.upper_bound(index);
  return after == checkpoints_.begin() ? 0 : std::prev(after)->first;
}

ReplayableRun::Rewound ReplayableRun::rewound(int index, const ReadFrame& read) const {
  const int first = checkpoint_before(index);
  // A finished run that odometry has not seen here has none.
  const auto kept = checkpoints_.find(first);
  Rewound rewound{kept == checkpoints_.end() ? Odometry(source_->camera(), config()) : kept->second, first};
  rewound.odometry.restore_images(first, read);
  return rewound;
}

Odometry ReplayableRun::before(int index, const ReadFrame& read) const {
  Rewound way = rewound(index, read);
  Prefetcher frames(*source_, way.next, index, 2);
  for (; way.next < index; ++way.next)
    (void)process(way.odometry, way.next, [&frames](int) { return frames.next(); });
  return std::move(way.odometry);
}

std::set<int> ReplayableRun::frames_to_restore(int index) const {
  const auto after = checkpoints_.upper_bound(index);
  std::set<int> frames;
  if (after == checkpoints_.begin()) return frames;
  const int first = std::prev(after)->first;
  for (int i = std::max(0, first - frames_compared_back(source_->camera(), config())); i < first; ++i)
    frames.insert(i);
  return frames;
}

FrameResult ReplayableRun::replay(int index, const ReadFrame& read) const {
  Odometry odometry = before(index, read);
  return process(odometry, index, read);
}

std::vector<PastFrame> ReplayableRun::frames_before(int index, int count, const ReadFrame& read) const {
  std::vector<PastFrame> past;
  for (int i = std::max(0, index - count); i < index; ++i) {
    const FrameRecord& record = records_[static_cast<std::size_t>(i)];
    past.push_back({read(i), record.world_from_camera.inverse(), record.estimated});
  }
  return past;
}

ReplayableRun ReplayableRun::branch(int from, const Config& config, const ReadFrame& read) const {
  ReplayableRun other(*source_, config, options_);
  if (from <= begins_at_ || from >= processed() || !outside().empty()) return other;
  const Odometry here = before(from, read);
  std::optional<Odometry> odometry =
      here.continued_with(config, frames_before(from, here.frames_wanted(config), read));
  if (!odometry) return other;
  other.odometry_ = std::move(*odometry);
  other.begins_at_ = from;
  other.seen_ = from;
  other.records_ = records_.first(static_cast<std::size_t>(from));
  other.features_ = features_.first(static_cast<std::size_t>(from));
  other.recorded_features_ = recorded_features_;
  other.recorded_frames_ = std::min(recorded_frames_, from);
  other.scores_ = scores_.first(static_cast<std::size_t>(from));
  for (const FrameRecord& record : other.records_) {
    other.hash_.add(record);
    add_pose(record, other.poses_);
  }
  return other;
}

MeasuredFrames ReplayableRun::measured() const { return {records_, nullptr, &scores_, columns_.get()}; }

RunView ReplayableRun::view() const {
  RunView view;
  view.name = name();
  view.records = records_;
  view.scores = scores_;
  view.columns = columns_;
  view.trajectory = is_as_recorded() ? recorded_->run.trajectory : trajectory_so_far(odometry_, poses_);
  if (!source_->ground_truth().empty() && !view.trajectory.empty()) {
    EvaluationOptions options;
    options.expected_frames = processed();
    view.evaluation = evaluate_trajectory(source_->ground_truth(), view.trajectory, options);
  }
  return view;
}

}  // namespace stillpoint
