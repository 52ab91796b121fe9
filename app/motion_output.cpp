#include "app/motion_output.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>

#include "app/layer_pictures.hpp"
#include "core/error.hpp"
#include "core/out_folder.hpp"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;

constexpr const char* kMask = "mask.png";
constexpr const char* kOverlay = "overlay.png";

/// A field of a CSV row, in quotes where it needs them.
std::string csv_field(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char letter : text) quoted += letter == '"' ? "\"\"" : std::string(1, letter);
  return quoted + '"';
}

std::string csv_heading(const MethodInfo& method) {
  std::string heading = "reference,target,mask_share,regions,rounds";
  for (const FigureInfo& figure : method.figures) heading += ',' + csv_field(figure.name);
  return heading + ",note";
}

/// A frame's row; what does not exist stays empty.
std::string csv_row(const JudgedFrame& frame, const MethodInfo& method) {
  const MotionResult& result = frame.result;
  std::string row = csv_field(frame.reference) + ',' + csv_field(frame.target);
  row += result.mask.empty() ? ",," : fmt::format(",{:.6f},{}", result.mask_share, frame.regions.size());
  row += result.rounds == 0 ? "," : fmt::format(",{}", result.rounds);
  for (std::size_t i = 0; i < method.figures.size(); ++i) {
    row += ',';
    if (i < result.figures.size() && std::isfinite(result.figures[i]))
      row += fmt::format("{:.{}f}", result.figures[i], method.figures[i].digits);
  }
  return row + ',' + csv_field(frame.note());
}

nlohmann::json or_null(bool there, const nlohmann::json& value) { return there ? value : nlohmann::json(); }

nlohmann::json stage_json(const Stage& stage) {
  nlohmann::json figures = nlohmann::json::array();
  for (const StageFigure& figure : stage.figures)
    figures.push_back({{"name", figure.name}, {"value", figure.value}, {"unit", figure.unit}});
  // Rounds and references count from 1, as folders and groups do.
  return {{"id", stage.id},
          {"round", or_null(stage.round >= 0, stage.round + 1)},
          {"reference", or_null(stage.reference >= 0, stage.reference + 1)},
          {"group", stage.group},
          {"name", stage.name},
          {"ms", or_null(stage.timed, std::round(1000.0 * stage.ms) / 1000.0)},
          {"note", stage.note},
          {"figures", figures}};
}

nlohmann::json frame_json(const JudgedFrame& frame) {
  nlohmann::json regions = nlohmann::json::array(), stages = nlohmann::json::array();
  for (const MotionRegion& region : frame.regions)
    regions.push_back({{"x", region.box.x},
                       {"y", region.box.y},
                       {"width", region.box.width},
                       {"height", region.box.height},
                       {"area_px", region.area}});
  for (const Stage& stage : frame.log.stages) stages.push_back(stage_json(stage));
  nlohmann::json json = {{"reference", or_null(!frame.reference.empty(), frame.reference)},
                         {"target", frame.target},
                         {"mask_share", or_null(!frame.result.mask.empty(), frame.result.mask_share)},
                         {"regions", regions},
                         {"note", frame.note()},
                         {"stages", stages}};
  if (frame.log.forward) json["target_from_reference"] = frame.log.forward->val;
  if (frame.log.backward) json["reference_from_target"] = frame.log.backward->val;
  return json;
}

/// The pictures that an earlier run left, by file name; `mask.png` and `overlay.png` at least.
std::set<std::string> earlier_pictures(const fs::path& folder) {
  std::set<std::string> names = {kMask, kOverlay};
  std::ifstream file(folder / "motion.json");
  const nlohmann::json earlier = nlohmann::json::parse(file, nullptr, false);
  if (!earlier.is_object() || !earlier.contains("pictures") || !earlier["pictures"].is_array()) return names;
  for (const nlohmann::json& name : earlier["pictures"]) {
    if (!name.is_string()) continue;
    // A list that someone edited must not lead elsewhere.
    const fs::path path = name.get<std::string>();
    if (path == path.filename() && path.extension() == ".png") names.insert(path.string());
  }
  return names;
}

/// Whether all of `text` from `first` on is digits, at least one.
bool is_number_from(const std::string& text, std::size_t first) {
  return text.size() > first && std::all_of(text.begin() + static_cast<std::ptrdiff_t>(first), text.end(),
                                            [](unsigned char letter) { return std::isdigit(letter) != 0; });
}

/// Removes an earlier result's pictures, those of each frame and of each round, and the folders that are
/// empty then.
void clear_earlier(const fs::path& folder, const std::set<std::string>& names) {
  std::error_code ignored;
  for (const std::string& name : names) fs::remove(folder / name, ignored);
  std::vector<fs::path> below;
  for (const auto& entry : fs::directory_iterator(folder, ignored)) {
    const std::string name = entry.path().filename().string();
    if (entry.is_directory() &&
        (is_number_from(name, 0) || (name.starts_with("round_") && is_number_from(name, 6))))
      below.push_back(entry.path());
  }
  for (const fs::path& one : below) {
    clear_earlier(one, names);
    fs::remove(one, ignored);  // which leaves a folder that is not empty
  }
}

/// The ids of all layers that have one, in no order that matters.
std::set<std::string> layer_ids(const StageLog& log) {
  std::set<std::string> ids;
  for (const Stage& stage : log.stages)
    for (const StageSide& side : stage.sides) {
      ids.insert(side.output.id);
      for (const Layer& input : side.inputs) ids.insert(input.id);
    }
  ids.erase("");
  return ids;
}

}  // namespace

MotionOutput::MotionOutput(const fs::path& folder, bool force, bool all_rounds, const MethodInfo& method,
                           int frames_back)
    : folder_(folder), all_rounds_(all_rounds), method_(method), frames_back_(frames_back) {
  prepare_out_folder(folder, {"motion.csv", "motion.json", "config.toml"}, force);
  if (fs::exists(folder / "motion.csv")) clear_earlier(folder, earlier_pictures(folder));
  csv_.open(folder / "motion.csv");
  csv_ << csv_heading(method) << '\n' << std::flush;
  if (!csv_) throw InputError(fmt::format("{}: cannot be written", (folder / "motion.csv").string()));
  write_json();
}

void MotionOutput::add(const JudgedFrame& frame) {
  const std::size_t names_before = pictures_.size();
  if (!frame.picture.empty()) write_layers(frame);
  if (!frame.picture.empty() && !frame.result.mask.empty()) {
    std::string partial_name = method_.partial_mask;
    std::replace(partial_name.begin(), partial_name.end(), '_', ' ');
    write(frame.subfolder, kMask, frame.result.mask);
    write(frame.subfolder, kOverlay,
          draw_mask_overlay(frame.picture, frame.result.mask, frame.regions, frame.result.partial_mask,
                            partial_name));
  }
  csv_ << csv_row(frame, method_) << '\n' << std::flush;
  if (!csv_) throw InputError(fmt::format("{}: cannot be written", (folder_ / "motion.csv").string()));
  pairs_.push_back(frame_json(frame));
  if (frame.result.mask.empty()) ++without_mask_;
  // A run that is killed leaves a list of its pictures too.
  if (pictures_.size() > names_before) write_json();
}

void MotionOutput::finish(const Config& config) {
  write_json();
  write_text_file(folder_ / "config.toml", to_toml(config));
}

void MotionOutput::write_layers(const JudgedFrame& frame) {
  const StageLog& log = frame.log;
  const int rounds = all_rounds_ ? log.rounds() : 0;
  for (const std::string& id : layer_ids(log))
    for (int round = 0; round < std::max(1, rounds); ++round) {
      const int wanted = rounds > 0 ? round : -1;
      const Stage* stage = log.stage_of_layer(id, wanted);
      if (stage == nullptr) continue;
      const bool of_round = rounds > 0 && stage->round >= 0;
      if (round > 0 && !of_round) break;  // the same picture for every round
      const cv::Mat picture = draw_layer(*log.layer(id, wanted));
      const fs::path subfolder(frame.subfolder);
      if (!picture.empty())
        write(of_round ? subfolder / fmt::format("round_{}", round + 1) : subfolder, id + ".png", picture);
    }
}

void MotionOutput::write(const fs::path& subfolder, const std::string& name, const cv::Mat& picture) {
  prepare_out_folder(folder_ / subfolder, {}, true);
  write_picture(folder_ / subfolder / name, picture);
  pictures_.insert(name);
}

void MotionOutput::write_json() const {
  const nlohmann::json all = {
      {"method", method_.name}, {"reference_gap", frames_back_}, {"pictures", pictures_}, {"pairs", pairs_}};
  // File names need not be UTF-8.
  write_text_file(folder_ / "motion.json",
                  all.dump(1, ' ', false, nlohmann::json::error_handler_t::replace) + '\n');
}

}  // namespace stillpoint
