// Parsers of text that is at hand: lists, trajectories, TOML, YAML, conditions, recordings, sidecars,
// results.
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "core/config.hpp"
#include "core/evaluation/benchmark_results.hpp"
#include "core/evaluation/page_tables.hpp"
#include "core/geometry/camera.hpp"
#include "core/geometry/camera_yaml.hpp"
#include "core/geometry/trajectory_file.hpp"
#include "core/inspect/sidecar.hpp"
#include "core/motion/methods.hpp"
#include "core/odometry/frame_record.hpp"
#include "core/run/cell_plan.hpp"
#include "core/run/condition.hpp"
#include "core/sequence/list_file.hpp"
#include "core/sequence/write_sequence.hpp"
#include "tests/fuzz/targets.hpp"
#include "ui/shell/recording.hpp"

namespace stillpoint::fuzz {
namespace {

using Seeds = std::vector<std::string>;

const MarkedSequence kMarked{"street", "0123456789abcdef", 50};

void read_any_list(std::string_view text) {
  std::vector<std::string> warnings;
  (void)read_list("rgb.txt", text, warnings);
}
Seeds list_seeds() {
  return {"# timestamp filename\n1.000000 rgb/1.000000.png\n1.033333 rgb/1.033333.png\n",
          "1311868164363 a b.png\r\n1311868164396 rgb\\b.png\r\n\xEF\xBB\xBF", "0 a\n0 a\n2 c\n1 b\n"};
}

void read_any_associations(std::string_view text) {
  std::vector<std::string> warnings;
  (void)read_associations("associations.txt", text, warnings);
}
Seeds association_seeds() {
  return {"1.0 rgb/1.png 1.01 depth/1.png\n1.03 rgb/2.png 1.04 depth/2.png\n",
          "1.01 depth/1.png 1.0 rgb/1.png\n"};
}

void read_any_trajectory(std::string_view text) { (void)read_trajectory_text("trajectory.txt", text); }
Seeds trajectory_seeds() {
  return {"# timestamp tx ty tz qx qy qz qw\n1.0 0 0 0 0 0 0 1\n1.1 0.1 0 0 0 0 0 1\n",
          "#timestamp,p_x [m],p_y,p_z,q_w [],q_x,q_y,q_z,v_x,v_y,v_z,b_x,b_y,b_z,a_x,a_y,a_z\n"
          "1403636580838555648,1,2,3,1,0,0,0,0,0,0,0,0,0,0,0,0\n",
          "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 0.5 0 1 0 0 0 0 1 0\n",
          "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1\n1 0 0 2 0 1 0 0 0 0 1 0 0 0 0 1\n",
          "timestamp;x;y;z;qw;qx;qy;qz\n1,5;0;0;0;1;0;0;0\n1,6;0,25;0;0;1,0;0;0;0\n"};
}

void read_any_config(std::string_view text) { (void)config_from_toml(std::string(text), "config.toml"); }
Seeds config_seeds() {
  const std::string whole = to_toml(Config());  // each key with its meaning: its beginning does for all
  return {whole.substr(0, whole.find("\n\n", 2000)),
          "[run]\nmethod = \"paper\"\nseed = 3\n[features]\nscale_factor = 1.5e0\n",
          "run.check_removal = 1\n[features]\ncount = 0x200\n"};
}

void read_any_setting(std::string_view text) {
  Config config;
  set_parameter(config, text);
}
Seeds setting_seeds() { return {"run.seed=3", "features.scale_factor=1.5", "run.method=paper"}; }

void read_any_camera_toml(std::string_view text) { (void)read_camera_text("camera.toml", std::string(text)); }
Seeds camera_toml_seeds() {
  Camera camera;
  camera.depth_camera = std::make_shared<const DepthCamera>();
  return {camera_text(Camera{}), camera_text(camera)};
}

void read_any_camera_yaml(std::string_view text) { (void)read_camera_text("camera.yaml", std::string(text)); }
Seeds camera_yaml_seeds() {
  return {
      "%YAML:1.0\nCamera.type: \"PinHole\"\nCamera.fx: 517.3\nCamera.fy: 516.5\nCamera.cx: 318.6\n"
      "Camera.cy: 255.3\nCamera.k1: 0.26\nCamera.width: 640\nCamera.height: 480\nCamera.bf: 40\n"
      "DepthMapFactor: 5000\n",
      "cam0:\n  camera_model: pinhole\n  intrinsics: [458, 457, 367, 248]\n  distortion_model: radtan\n"
      "  distortion_coeffs: [-0.28, 0.07, 0.0002, 1.7e-05]\n  resolution: [752, 480]\n",
      "image_width: 640\nimage_height: 480\ncamera_matrix: !!opencv-matrix\n  rows: 3\n  cols: 3\n  dt: d\n"
      "  data: [525, 0, 319.5, 0, 525, 239.5, 0, 0, 1]\ndistortion_coefficients:\n  data: [0, 0, 0, 0, 0]\n"};
}

void read_any_sensor_yaml(std::string_view text) {
  (void)read_yaml_body_from_sensor("sensor.yaml", std::string(text));
}
Seeds sensor_yaml_seeds() {
  return {"T_BS:\n  cols: 4\n  rows: 4\n  data: [0, -1, 0, 0.1, 1, 0, 0, 0.2, 0, 0, 1, 0.3, 0, 0, 0, 1]\n"};
}

void read_any_condition(std::string_view text) {
  // A condition is read, and asked of a run of few frames.
  std::vector<FrameRecord> records(12);
  for (std::size_t i = 0; i < records.size(); ++i) records[i].index = static_cast<int>(i);
  (void)Condition(text).frames(FrameFigures({records, nullptr, nullptr}));
}
Seeds condition_seeds() {
  return {"rpe > 5 cm || inliers < 30 && !lost",
          "spike(abs(change(inliers)), 3) or previous(ptam_found) >= 40 %",
          "not (-inliers + 2 * 3 / 4 - 1 != matches)"};
}

void read_any_recording(std::string_view text) {
  for (const RecordedLine& line : parse_recording(std::string(text), "session.txt").lines)
    (void)to_line(line.what);
}
Seeds recording_seeds() {
  return {
      "stillpoint recording 1\nsequence 300 generated:walking_static\nopened generated:walking_static\n"
      "size 1600 900\nlook dark 1\nlayout {\"panel\": \"input\"}\nset run.method=paper\nkey Right\nidle\n"
      "screenshot after.png\n",
      "stillpoint recording 1\nwait 0.5\nuntil 12\nframe 12\naction toggle_theme\npoint errors 0.5 0.2\n"
      "size 800 600\nexpect frame 12\nmove 10 20\npress left Ctrl\nrelease left\nwheel 0 1\ntext "
      "\"a\"\nfocus out\nquit\n"};
}

void read_any_marks(std::string_view text) { (void)read_marks(file_of(text, kSidecarName), kMarked); }
Seeds marks_seeds() {
  const Marks marks{{{3, "here it is lost"}}, {{4, 10.5, 20.0, "A"}},
                    {{"rpe > 0.05", true}},   {{5, {{{1.5, 2}, {30, 2}, {30, 40}}}}, {7, {}}},
                    FrameSpan{2, 9},          true};
  return {written(kSidecarName, [&](const std::string& path) { write_marks(path, kMarked, marks); })};
}

void read_any_results(std::string_view text) { (void)results_from_json(std::string(text), "results.json"); }
Seeds results_seeds() {
  BenchmarkResults results;
  results.runs.resize(2);
  results.runs[1].ate_m = 0.5, results.runs[1].right = 3;
  return {to_json(results).dump(1)};
}

void read_any_plan(std::string_view text) {
  const CellPlan plan = plan_from_json(std::string(text), kPlanName);
  (void)merge_cells(plan, {std::vector<std::optional<CellRecord>>(plan.cells.size()),
                           std::vector<bool>(plan.cells.size())});
  (void)plan.fingerprint();
}
Seeds plan_seeds() {
  CellPlan plan;
  plan.kind = "benchmark", plan.engines = {"features"}, plan.methods = {"none"};
  plan.sequences = {{"street", "/data/street", "street", {"depth_scale=1000"}}};
  plan.cells = {{"street", "features", "none", 0, "", 9}, {"street", "features", "none", 1, "huber", 8}};
  plan.known = {{plan.cells[0], "{\"rpe_m\": 0.5}"}};
  return {to_json_text(plan)};
}

void read_any_cell_record(std::string_view text) { (void)record_from_json(std::string(text), "000001.json"); }
Seeds cell_record_seeds() {
  return {to_json_text(CellRecord{1, "0123", "abcd", "a machine", 0, "", "{\"rpe_m\": 0.5}"}),
          to_json_text(CellRecord{2, "0123", "abcd", "a machine", 139, "frame 3"})};
}

void read_any_page(std::string_view text) {
  BenchmarkResults results;
  results.runs.resize(2);
  for (BenchmarkResult& run : results.runs) run.sequence = "street", run.odometry = "features";
  results.runs[0].method = "none", results.runs[1].method = "paper";
  (void)with_tables(std::string(text), "README.md", "none",
                    {[&](const std::string&) { return results; }, [](const std::string&) { return Table(); },
                     [&](const std::string&) { return results; }});
}
Seeds page_seeds() {
  return {"# A page\n\n<!-- table: results/table1.json rpe methods=none,paper -->\n<!-- end of table -->\n",
          "<!-- table: r.json gain sequences=str*,* odometry=features names=long -->\nold\n"
          "<!-- end of table -->\nafter\n"};
}

}  // namespace

std::vector<Target> text_targets() {
  // Lines, columns and the nodes of a tree take some hundred bytes for a word of few letters; the base is the
  // config.
  constexpr Bound kWords{512 << 10, 400};
  return {{"list", kWords, read_any_list, list_seeds},
          {"associations", kWords, read_any_associations, association_seeds},
          {"trajectory", kWords, read_any_trajectory, trajectory_seeds},
          {"toml", kWords, read_any_config, config_seeds},
          {"setting", kWords, read_any_setting, setting_seeds},
          {"camera_toml", kWords, read_any_camera_toml, camera_toml_seeds},
          {"camera_yaml", kWords, read_any_camera_yaml, camera_yaml_seeds},
          {"sensor_yaml", kWords, read_any_sensor_yaml, sensor_yaml_seeds},
          {"condition", kWords, read_any_condition, condition_seeds},
          {"recording", kWords, read_any_recording, recording_seeds},
          {"sidecar", kWords, read_any_marks, marks_seeds},
          {"results", kWords, read_any_results, results_seeds},
          {"page", kWords, read_any_page, page_seeds},
          {"plan", kWords, read_any_plan, plan_seeds},
          {"cell_record", kWords, read_any_cell_record, cell_record_seeds}};
}

}  // namespace stillpoint::fuzz
