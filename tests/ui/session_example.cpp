#include "tests/ui/session_example.hpp"

#include "core/evaluation/trajectory_metrics.hpp"
#include "core/inspect/frame_view.hpp"
#include "core/inspect/motion_replay.hpp"
#include "core/inspect/run_view.hpp"
#include "core/odometry/frame_result.hpp"
#include "core/run/run_sequence.hpp"
#include "ui/panels/panel.hpp"

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

/// Another method's stages of a frame, as a session lays them beside.
static std::shared_ptr<const StageLog> stages_beside(const FrameSource& source, const char* method,
                                                     int index) {
  Config config;
  config.run.method = method;
  const auto read = [&source](int i) { return source.read(i); };
  MotionReplay replay(source.camera(), config, MotionStage(source.camera(), config), index, index, read);
  const Frame frame = source.read(index);
  const MotionAgain again = replay.repeat(frame, nullptr);
  return std::make_shared<const StageLog>(replay.describe(frame, again.motion));
}

SessionExample run_example(std::unique_ptr<FrameSource> source, int frames, double rpe_delta_s) {
  SessionExample example;
  SessionView& view = example.view;
  Config config;
  config.run.method = "stillpoint";
  auto current = std::make_shared<FrameView>();
  MotionResult motion;
  RunOptions options;
  options.count = frames;
  options.keep_features = true;
  options.on_frame = [&](const FrameResult& result) {
    if (result.record.index != frames - 1) return;
    motion = result.motion;
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
  current->motion = std::make_shared<const StageLog>(
      MotionStage(source->camera(), run.config).describe(current->frame, motion));
  current->motion_beside = stages_beside(*source, "paper", frames - 1);
  current->truth = source->truth(frames - 1);
  current->record = &*std::prev(view.run->records.end());
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

const FrameRecord* record_in(const RunView& run, std::size_t row) {
  return &*(run.records.begin() + static_cast<std::ptrdiff_t>(row));
}

std::vector<std::string> panel_names() {
  std::vector<std::string> names;
  for (const auto& panel : make_panels()) names.push_back(panel->name());
  return names;
}

}  // namespace stillpoint::testing
