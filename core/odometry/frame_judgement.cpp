#include "core/odometry/frame_judgement.hpp"

#include "core/stopwatch.hpp"

namespace stillpoint {

void judge(const MotionStage& motion, const MotionInput& input, FrameResult& result) {
  const Stopwatch watch;
  result.motion = motion.detect(input);
  result.mask = result.motion.mask;
  FrameRecord& record = result.record;
  record.mask_share = result.motion.mask_share;
  record.motion_rounds = result.motion.rounds;
  record.mask_problem = result.motion.mask_problem;
  const std::vector<FigureInfo>& infos = motion.info_for(input.frame).figures;
  record.motion_figures.clear();
  for (std::size_t i = 0; i < result.motion.figures.size() && i < infos.size(); ++i)
    record.motion_figures.push_back({infos[i].name, result.motion.figures[i]});
  if (input.camera_from_world) record.motion_pose = input.camera_from_world;
  record.ms.motion += watch.milliseconds();
}

void expect(const MotionStage& motion, const MotionInput& input, FrameResult& result) {
  const Stopwatch watch;
  result.record.prior_pose = input.camera_from_world;
  result.mask = motion.prior_mask(input);
  result.record.ms.motion += watch.milliseconds();
}

void withdraw(FrameResult& result) {
  result.mask.release();
  result.motion.mask.release();
  result.motion.weight_of_feature.clear();
  if (!result.motion.log_odds.empty())
    result.motion.log_odds = cv::Mat::zeros(result.motion.log_odds.size(), CV_32FC1);
  FrameRecord& record = result.record;
  record.mask_share = 0.0;
  record.note += (record.note.empty() ? "" : "; ") +
                 std::string("too little is left without what is dynamic, so nothing was removed");
}

std::vector<MotionFeature> motion_features(const TrackedFrame& first, const LocalMap& map) {
  std::vector<MotionFeature> features(first.records.size());
  for (std::size_t i = 0; i < features.size(); ++i) {
    features[i].pixel = first.records[i].pixel;
    features[i].depth = first.records[i].depth;
  }
  for (std::size_t f = 0; f < first.points.size(); ++f) {
    if (first.points[f] == kNone) continue;
    MotionFeature& feature = features[static_cast<std::size_t>(first.record_of[f])];
    feature.map_point = first.points[f];
    feature.world = map.point(first.points[f]).position;
  }
  return features;
}

}  // namespace stillpoint
