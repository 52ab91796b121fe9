#include "ui/session/run_track.hpp"

#include <utility>

namespace stillpoint {

RunTrack::RunTrack(const FrameSource& source, const Config& config, const RunTrackOptions& options)
    : source_(&source), options_(options), odometry_(source.camera(), config) {}

FrameResult RunTrack::process(Odometry& odometry, int index, const ReadFrame& read) const {
  const bool told = config().run.method == "oracle" && source_->has_masks();
  FrameResult result = odometry.process(read(index), told ? source_->truth(index).moving : cv::Mat());
  if (!options_.keep_times) result.record.ms = {};
  return result;
}

FrameResult RunTrack::process_next(const ReadFrame& read) {
  const int index = processed();
  while (seen_ < index) catch_up_one(read);
  if (index % options_.checkpoint_every == 0) keep_checkpoint();
  FrameResult result = process(odometry_, index, read);
  ++seen_;
  // What a batch run does after its last frame.
  if (index + 1 == source_->size()) odometry_.finish();
  features_.push_back(options_.keep_features ? result.record.features : std::vector<FeatureRecord>());
  records_.push_back(result.record);
  records_.back().features = {};
  return result;
}

FrameRecord RunTrack::record(int index) const {
  FrameRecord record = records_[static_cast<std::size_t>(index)];
  record.features = features_[static_cast<std::size_t>(index)];
  return record;
}

void RunTrack::keep_checkpoint() {
  checkpoints_.emplace(seen_, odometry_);
  if (static_cast<int>(checkpoints_.size()) <= options_.max_checkpoints) return;
  options_.checkpoint_every *= 2;
  std::erase_if(checkpoints_,
                [this](const auto& kept) { return kept.first % options_.checkpoint_every != 0; });
}

FrameResult RunTrack::replay(int index, const ReadFrame& read) const {
  const auto& [first, kept] = *std::prev(checkpoints_.upper_bound(index));
  Odometry odometry = kept;
  for (int before = first; before < index; ++before) (void)process(odometry, before, read);
  return process(odometry, index, read);
}

RunView RunTrack::view() const {
  RunView view;
  view.name = config().run.method;
  view.records = records_;
  view.trajectory =
      is_as_recorded() ? recorded_->run.trajectory : trajectory_so_far(odometry_.map(), records_);
  if (!source_->ground_truth().empty() && !view.trajectory.empty()) {
    EvaluationOptions options;
    options.expected_frames = processed();
    view.evaluation = evaluate_trajectory(source_->ground_truth(), view.trajectory, options);
  }
  return view;
}

}  // namespace stillpoint
