// The part of ReplayableRun that has a finished run: all that its records hold at once, and what they do not
// hold once odometry has seen the frames again.
#include "core/inspect/replayable_run.hpp"
#include "core/inspect/run_view.hpp"
#include "core/odometry/engines.hpp"
#include "core/run/frame_figures.hpp"
#include "core/run/frame_records.hpp"

namespace stillpoint {

ReplayableRun::ReplayableRun(const FrameSource& source, std::shared_ptr<const RecordedRun> recorded,
                             const ReplayableRunOptions& options)
    : source_(&source),
      options_(options),
      recorded_(std::move(recorded)),
      odometry_(source.camera(), recorded_->run.config),
      poses_(poses_put_by(store_)),
      columns_(std::make_shared<FigureColumns>()),
      motion_state_every_(odometry_.motion().info().needs.checkpoint_every) {
  scores_ = recorded_->run.scores;
  scores_.resize(recorded_->run.records.size());
  records_ = recorded_->run.records;
  for (const FrameRecord& record : records_) hash_.add(record);
  features_.resize(records_.size());
  if (options_.keep_features) recorded_features_ = recorded_->details;
  recorded_frames_ = processed();
  if (!recorded_->outside.empty()) seen_ = processed();
}

std::string ReplayableRun::name() const { return recorded_ ? run_name(*recorded_) : run_label(config()); }

void ReplayableRun::catch_up_one(const ReadFrame& read) {
  if (seen_ % options_.checkpoint_every == 0) keep_checkpoint();
  keep_motion_state();
  const Frame frame = read(seen_);
  (void)process(odometry_, seen_, [&frame](int) { return frame; });
  ++seen_;
  if (seen_ == source_->size()) odometry_.finish();
}

bool ReplayableRun::is_as_recorded() const {
  return recorded_ && records_.size() == recorded_->run.records.size();
}

std::vector<SavedKeyframe> ReplayableRun::keyframes() const {
  return is_as_recorded() ? recorded_->run.keyframes : saved_keyframes(odometry_.map());
}

std::vector<SavedPoint> ReplayableRun::points() const {
  const bool recorded = is_as_recorded();
  std::vector<SavedPoint> points = recorded ? recorded_->run.points : saved_points(odometry_.map());
  const std::vector<SavedPoint> moved = recorded ? recorded_->run.moved : moved_points(odometry_.map());
  points.insert(points.end(), moved.begin(), moved.end());
  return points;
}

cv::Mat ReplayableRun::recorded_mask(int index) const {
  const auto at = static_cast<std::size_t>(index);
  return recorded_ && at < recorded_->run.records.size() ? recorded_->mask(at) : cv::Mat();
}

}  // namespace stillpoint
