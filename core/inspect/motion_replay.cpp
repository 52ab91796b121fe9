#include "core/inspect/motion_replay.hpp"

namespace stillpoint {

MotionReplay::MotionReplay(const Camera& camera, const Config& config)
    : camera_(camera), config_(config), stage_(camera, config), preparer_(camera, config) {}

MotionReplay::MotionReplay(const Camera& camera, const Config& config, MotionStage state, int next, int last,
                           const MotionMethod::ReadFrame& read)
    : camera_(camera), config_(config), stage_(std::move(state)), preparer_(camera, config) {
  preparer_.restore(next, config.run.threads, read);
  stage_.restore_images(next, last, read);
}

MotionAgain MotionReplay::repeat(const Frame& frame, const FrameRecord* record, const cv::Mat& true_mask) {
  MotionAgain again;
  if (!frame.readable()) return again;
  MotionInput input{frame, preparer_.prepare(frame, config_.run.threads)};
  input.threads = config_.run.threads;
  const MotionNeeds& needs = stage_.info_for(frame).needs;
  if (needs.true_mask) input.true_mask = true_mask;
  if (!needs.first_pose) {
    again.motion = stage_.detect(input);
    again.mask = again.motion.mask;
  } else if (record != nullptr) {
    input.camera_from_world = record->prior_pose;
    if (input.camera_from_world) again.mask = stage_.prior_mask(input);
    // A run by another method has no first pose of its own: its final one stands for it.
    input.camera_from_world = record->motion_pose;
    if (!as_the_run_ && !input.camera_from_world && record->estimated)
      input.camera_from_world = record->world_from_camera.inverse();
    if (input.camera_from_world) {
      again.motion = stage_.detect(input);
      again.mask = again.motion.mask;
    }
  }
  // The run found that too little was left without what is dynamic, removed nothing and withdrew the
  // judgement.
  const bool prior_alone =
      needs.first_pose && record != nullptr && !record->motion_pose && record->features_removed == 0;
  if (as_the_run_ && record != nullptr && record->mask_share == 0.0 &&
      (again.motion.mask_share > 0.0 || prior_alone)) {
    again.mask.release();
    if (!again.motion.log_odds.empty())
      again.motion.log_odds = cv::Mat::zeros(again.motion.log_odds.size(), CV_32FC1);
  }
  const MotionOutcome outcome = record == nullptr
                                    ? MotionOutcome{}
                                    : MotionOutcome{record->estimated, record->world_from_camera.inverse()};
  stage_.commit(input, again.motion, outcome);
  return again;
}

MotionReplay MotionReplay::continued_with(const Config& config, const std::vector<PastFrame>& before) const {
  MotionReplay other(camera_, config);
  other.stage_ = stage_.continued_with(config, before);
  if (frames_wanted(config) == 0) {
    for (const auto& preparation : preparer_.past()) other.preparer_.pass(preparation);
  } else {
    for (const PastFrame& past : before)
      if (past.frame.readable()) (void)other.preparer_.prepare(past.frame, config.run.threads);
  }
  other.as_the_run_ = false;
  return other;
}

}  // namespace stillpoint
