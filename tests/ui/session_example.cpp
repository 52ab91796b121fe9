#include "tests/ui/session_example.hpp"

#include "core/motion/detect_motion.hpp"
#include "core/run/run_sequence.hpp"

namespace stillpoint::testing {
namespace {

std::shared_ptr<RunView> run_view(const RunResult& run, const Trajectory& truth, double rpe_delta_s) {
  auto view = std::make_shared<RunView>();
  view->name = run.config.run.method;
  view->records = run.records;
  view->trajectory = run.live;
  EvaluationOptions options;
  options.delta_s = rpe_delta_s;
  if (!truth.empty()) view->evaluation = evaluate_trajectory(truth, run.live, options);
  return view;
}

}  // namespace

SessionExample run_example(std::unique_ptr<FrameSource> source, int frames, double rpe_delta_s) {
  SessionExample example;
  SessionView& view = example.view;
  Config config;
  config.run.method = "stillpoint";
  auto current = std::make_shared<FrameView>();
  RunOptions options;
  options.count = frames;
  options.keep_features = true;
  options.on_frame = [&](const FrameResult& result) {
    if (result.record.index != frames - 1) return;
    current->depth_motion = result.depth_motion;
    current->mask = result.mask;
  };
  const RunResult run = run_sequence(*source, config, options);
  options.on_frame = {};
  config.run.method = "none";
  const RunResult baseline = run_sequence(*source, config, options);

  view.run = run_view(run, source->ground_truth(), rpe_delta_s);
  view.baseline = run_view(baseline, source->ground_truth(), rpe_delta_s);
  current->index = frames - 1;
  current->frame = source->read(frames - 1);
  current->reference = source->read(frames - 2);
  current->motion = detect_motion(current->reference.gray, current->frame.gray, run.config.motion);
  current->truth = source->truth(frames - 1);
  current->record = &view.run->records.back();
  view.title = source->name();
  view.camera = source->camera();
  view.config = run.config;
  view.frame_count = source->size();
  view.processed = frames;
  view.current = current;
  view.ground_truth = source->ground_truth();
  view.alignment = view.run->evaluation.ate.alignment;
  view.keyframes = run.keyframes;
  view.map_points = run.points;
  view.revision = 1;
  example.source = std::move(source);
  return example;
}

const SessionView& generated_example() {
  static const SessionExample example = [] {
    OpenOptions options;
    options.frames = 20;
    return run_example(open_sequence("generated:walking_static", options), 14, 0.2);
  }();
  return example.view;
}

}  // namespace stillpoint::testing
