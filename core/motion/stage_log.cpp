#include "core/motion/stage_log.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace stillpoint {
namespace {

const Layer* layer_in(const Stage& stage, const std::string& id) {
  for (const StageSide& side : stage.sides) {
    if (side.output.id == id) return &side.output;
    for (const Layer& input : side.inputs)
      if (input.id == id && side.name.empty()) return &input;
  }
  return nullptr;
}

}  // namespace

std::string Layer::word_of(MarkKind mark) const {
  if (const auto own = words.find(mark); own != words.end()) return own->second;
  switch (mark) {
    case MarkKind::kInlier:
      return "inlier";
    case MarkKind::kOutlier:
      return "outlier";
    case MarkKind::kRemoved:
      return "removed";
    case MarkKind::kKept:
      return "kept";
    case MarkKind::kUnmatched:
      return "unmatched";
    case MarkKind::kGained:
      return "gained";
    case MarkKind::kLost:
      return "lost";
  }
  return {};
}

Stage& StageLog::add(std::string id, std::string group, std::string name, std::string what) {
  Stage stage;
  stage.id = std::move(id);
  stage.group = std::move(group);
  stage.name = std::move(name);
  stage.what = std::move(what);
  stages.push_back(std::move(stage));
  return stages.back();
}

const Stage* StageLog::stage_of_layer(const std::string& id, int round) const {
  for (auto stage = stages.rbegin(); stage != stages.rend(); ++stage)
    if ((round < 0 || stage->round < 0 || stage->round == round) && layer_in(*stage, id) != nullptr)
      return &*stage;
  return nullptr;
}

const Layer* StageLog::layer(const std::string& id, int round) const {
  const Stage* stage = stage_of_layer(id, round);
  return stage == nullptr ? nullptr : layer_in(*stage, id);
}

int StageLog::rounds() const {
  int last = -1;
  for (const Stage& stage : stages) last = std::max(last, stage.round);
  return last + 1;
}

Layer photo_layer(std::string name, const cv::Mat& image, FrameSpace space) {
  Layer layer;
  layer.name = std::move(name);
  layer.image = image;
  layer.space = space;
  return layer;
}

Layer mask_layer(std::string name, const cv::Mat& mask, const Layer& ground, std::string id) {
  Layer layer;
  layer.name = std::move(name);
  layer.kind = LayerKind::kMask;
  layer.image = mask;
  layer.ground = ground.image;
  layer.space = ground.space;
  layer.id = std::move(id);
  return layer;
}

Layer signed_layer(std::string name, const cv::Mat& values, double range, std::string unit, FrameSpace space,
                   std::optional<double> limit) {
  Layer layer;
  layer.name = std::move(name);
  layer.kind = LayerKind::kSigned;
  layer.image = values;
  layer.range = range;
  layer.unit = std::move(unit);
  layer.space = space;
  layer.limit = limit;
  return layer;
}

Layer length_layer(std::string name, const cv::Mat& values, std::string unit, FrameSpace space) {
  Layer layer;
  layer.name = std::move(name);
  layer.kind = LayerKind::kLength;
  layer.image = values;
  layer.unit = std::move(unit);
  layer.space = space;
  double largest = 0.0;
  if (!values.empty()) cv::minMaxLoc(values, nullptr, &largest);
  layer.range = std::max(1.0, largest);
  return layer;
}

Layer marked(std::string name, Layer ground, std::vector<Mark> marks) {
  ground.name = std::move(name);
  ground.marks = std::move(marks);
  return ground;
}

double percent_set(const cv::Mat& mask) {
  if (mask.empty()) return 0.0;
  return 100.0 * static_cast<double>(cv::countNonZero(mask)) / static_cast<double>(mask.total());
}

double percent_above(const cv::Mat& values, double limit) {
  if (values.empty()) return 0.0;
  return percent_set(values > limit);
}

double percent_known(const cv::Mat& values) {
  if (values.empty()) return 0.0;
  return percent_set(values == values);
}

std::string figure_text(const StageFigure& figure) {
  return fmt::format("{:.{}f}{}{}", figure.value, figure.digits, figure.unit.empty() ? "" : " ", figure.unit);
}

std::string change_text(const StageFigure& figure, double before) {
  const double change = figure.value - before;
  const double least = 0.5 * std::pow(10.0, -figure.digits);
  if (std::abs(change) < least) return "±0";
  return fmt::format("{:+.{}f}{}{}", change, figure.digits, figure.unit.empty() ? "" : " ", figure.unit);
}

std::size_t find_stage(const std::vector<Stage>& stages, const Stage& wanted) {
  std::optional<std::size_t> like;
  for (std::size_t i = 0; i < stages.size(); ++i) {
    if (stages[i].same_place(wanted)) return i;
    // Of a round this frame does not have, the last there is stands for it.
    if (stages[i].id == wanted.id) like = i;
  }
  return like.value_or(0);
}

}  // namespace stillpoint
