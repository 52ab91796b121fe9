#include "ui/panels/figure_sheet.hpp"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>

#include "core/inspect/frame_view.hpp"
#include "ui/panels/frame_pictures.hpp"
#include "ui/theme/fonts.hpp"

namespace stillpoint {
namespace {

constexpr int kMargin = 16, kHeading = 48;                                             // px at scale 1
constexpr int kCaptionAbove = 6, kCaptionLine = 15, kCaptionBelow = 12, kLetter = 26;  // px at scale 1
constexpr double kCharacter = 6.8;  // px at scale 1 that a character of a caption takes, wrapping included

/// Room for the longest caption under pictures of this width, both px at scale 1: known before there are
/// fonts.
int caption_height(const std::vector<FigureCell>& cells, int width) {
  std::size_t longest = 0;
  for (const FigureCell& cell : cells) longest = std::max(longest, cell.caption.size());
  const int lines =
      static_cast<int>(std::ceil(kCharacter * static_cast<double>(longest) / std::max(1, width - kLetter)));
  return kCaptionAbove + std::max(2, lines) * kCaptionLine + kCaptionBelow;
}

/// A figure of a stage as it reads, or a dash where the stage has none of that name.
std::string figure_of(const Stage& stage, const std::string& name) {
  for (const StageFigure& figure : stage.figures)
    if (figure.name == name) return figure_text(figure);
  return "–";
}

}  // namespace

std::vector<FigureCell> figure_1_cells(const SessionView& session) {
  const FrameView& view = *session.current;
  // Others have a compensated frame, too; this mask is of that method alone.
  const StageLog* log = stages_with(view, "union_mask");
  const Layer* united = log == nullptr ? nullptr : log->layer("union_mask");
  if (united == nullptr || united->image.empty()) return {};
  const cv::Mat forward = log->layer("forward_mask")->image,
                backward = log->layer("warped_backward_mask")->image;
  const auto threshold = [&](const char* layer) {
    return fmt::format("{:.0f}", log->layer(layer)->limit.value_or(0.0));
  };
  const Stage& flow = *log->stage_of_layer("flow_tracks");
  const double gain = percent_set(united->image) - percent_set(forward);
  return {
      {"a", fmt::format("Frame {}", view.reference.index), picture_of(view.reference)},
      {"b", fmt::format("Frame {}", view.index), picture_of(view.frame)},
      {"c",
       fmt::format("Frame {} compensated: seen from frame {}'s camera; {} inliers, RMS {}",
                   view.reference.index, view.index, figure_of(flow, "Forward: inliers"),
                   figure_of(flow, "Forward: RMS refined")),
       log->layer("compensated")->image},
      {"d",
       fmt::format("Forward mask: {:.1f} % of the image, threshold {} (Otsu), cleaned up",
                   percent_set(forward), threshold("difference")),
       forward},
      {"e",
       fmt::format("Backward mask, warped into frame {}: {:.1f} %, threshold {}", view.index,
                   percent_set(backward), threshold("difference_backward")),
       backward},
      {"f",
       fmt::format("Union, the motion mask: {:.1f} % of the image; {:.1f} % more than forward alone",
                   percent_set(united->image), gain),
       united->image},
  };
}

FigureSheet::FigureSheet(std::string heading, std::vector<FigureCell> cells, int columns)
    : heading_(std::move(heading)), cells_(std::move(cells)), columns_(columns) {}

std::pair<int, int> FigureSheet::size(double picture_scale) const {
  int width = 0, height = 0;
  for (const FigureCell& cell : cells_) {
    width = std::max(width, cvRound(picture_scale * cell.picture.cols));
    height = std::max(height, cvRound(picture_scale * cell.picture.rows));
  }
  const int rows = (static_cast<int>(cells_.size()) + columns_ - 1) / columns_;
  return {columns_ * (width + kMargin) + kMargin,
          kHeading + kMargin + rows * (height + caption_height(cells_, width))};
}

void FigureSheet::draw(UiFrame& frame) {
  if (textures_.empty())
    for (const FigureCell& cell : cells_) {
      textures_.emplace_back(frame.gl);
      textures_.back().upload(cell.picture);
    }
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  const float margin = kMargin * frame.scale, top = kHeading * frame.scale;
  list.AddRectFilled({0, 0}, frame.size, to_u32(frame.theme.panel));
  list.AddText(frame.fonts.heading, frame.fonts.heading->FontSize,
               {margin, 0.5F * (top - frame.fonts.heading->FontSize)}, to_u32(frame.theme.text),
               heading_.c_str());
  const int rows = (static_cast<int>(cells_.size()) + columns_ - 1) / columns_;
  const float width = std::floor((frame.size.x - margin) / static_cast<float>(columns_) - margin);
  const float caption =
      static_cast<float>(caption_height(cells_, static_cast<int>(width / frame.scale))) * frame.scale;
  const float height = std::floor((frame.size.y - top - margin) / static_cast<float>(rows) - caption);
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    const int column = static_cast<int>(i) % columns_, row = static_cast<int>(i) / columns_;
    const ImVec2 low{margin + static_cast<float>(column) * (width + margin),
                     top + static_cast<float>(row) * (height + caption)};
    const ImVec2 high{low.x + width, low.y + height};
    list.AddImage(textures_[i].imgui_id(), low, high);
    list.AddRect(low, high, to_u32(frame.theme.border));
    const std::string letter = fmt::format("({})", cells_[i].letter);
    const float below = high.y + kCaptionAbove * frame.scale;
    const ImFont *strong = frame.fonts.strong, *plain = frame.fonts.text;
    const float indent =
        strong->CalcTextSizeA(plain->FontSize, 1e6F, 0.0F, letter.c_str()).x + 5.0F * frame.scale;
    list.AddText(strong, plain->FontSize, {low.x, below}, to_u32(frame.theme.text), letter.c_str());
    list.AddText(plain, plain->FontSize, {low.x + indent, below}, to_u32(frame.theme.text),
                 cells_[i].caption.c_str(), nullptr, width - indent);
  }
}

}  // namespace stillpoint
