#include "ui/panels/figure_sheet.hpp"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>

#include "ui/panels/frame_pictures.hpp"

namespace stillpoint {
namespace {

constexpr int kMargin = 16, kHeading = 48, kCaption = 54;  // px at scale 1

double percent_of(const cv::Mat& mask) {
  return mask.empty() ? 0.0 : 100.0 * cv::countNonZero(mask) / static_cast<double>(mask.total());
}

std::string tracks_text(const DirectionTrace& direction) {
  const auto inliers = std::count_if(direction.tracks.begin(), direction.tracks.end(),
                                     [](const Track& track) { return track.inlier; });
  return fmt::format("H from {} of {} tracks, {:.2f} px RMS", inliers, direction.tracks.size(),
                     direction.homography.refined_error_px);
}

}  // namespace

std::vector<FigureCell> figure_1_cells(const SessionView& session) {
  const FrameView& view = *session.current;
  if (view.motion.rounds.empty() || view.motion.rounds.back().mask.empty()) return {};
  const MotionRound& round = view.motion.rounds.back();
  const DirectionTrace& forward = round.forward;
  const double gain = percent_of(round.mask) - percent_of(forward.mask);
  return {
      {"a", fmt::format("Frame {}", view.reference.index), picture_of(view.reference)},
      {"b", fmt::format("Frame {}", view.index), picture_of(view.frame)},
      {"c",
       fmt::format("Frame {} compensated: seen from frame {}'s camera. {}", view.reference.index, view.index,
                   tracks_text(forward)),
       forward.compensated},
      {"d",
       fmt::format("Forward mask: {:.1f} % of the image, threshold {} (Otsu), cleaned up",
                   percent_of(forward.mask), forward.threshold),
       forward.mask},
      {"e",
       fmt::format("Backward mask, carried into frame {}: {:.1f} %, threshold {}", view.index,
                   percent_of(round.backward_mask_in_target), round.backward.threshold),
       round.backward_mask_in_target},
      {"f",
       fmt::format("Union, the motion mask: {:.1f} % in {} regions; {:.1f} % more than forward alone",
                   percent_of(round.mask), round.regions.size(), gain),
       round.mask},
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
  return {columns_ * (width + kMargin) + kMargin, kHeading + kMargin + rows * (height + kCaption)};
}

void FigureSheet::draw(UiFrame& frame) {
  if (textures_.empty())
    for (const FigureCell& cell : cells_) {
      textures_.emplace_back(frame.gl);
      textures_.back().upload(cell.picture);
    }
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  const float margin = kMargin * frame.scale, caption = kCaption * frame.scale, top = kHeading * frame.scale;
  list.AddRectFilled({0, 0}, frame.size, to_u32(frame.theme.panel));
  list.AddText(frame.fonts.heading, frame.fonts.heading->FontSize,
               {margin, 0.5F * (top - frame.fonts.heading->FontSize)}, to_u32(frame.theme.text),
               heading_.c_str());
  const int rows = (static_cast<int>(cells_.size()) + columns_ - 1) / columns_;
  const float width = std::floor((frame.size.x - margin) / static_cast<float>(columns_) - margin);
  const float height = std::floor((frame.size.y - top - margin) / static_cast<float>(rows) - caption);
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    const int column = static_cast<int>(i) % columns_, row = static_cast<int>(i) / columns_;
    const ImVec2 low{margin + static_cast<float>(column) * (width + margin),
                     top + static_cast<float>(row) * (height + caption)};
    const ImVec2 high{low.x + width, low.y + height};
    list.AddImage(textures_[i].imgui_id(), low, high);
    list.AddRect(low, high, to_u32(frame.theme.border));
    const std::string letter = fmt::format("({})", cells_[i].letter);
    const float below = high.y + 6.0F * frame.scale;
    const ImFont *strong = frame.fonts.strong, *plain = frame.fonts.text;
    const float indent =
        strong->CalcTextSizeA(plain->FontSize, 1e6F, 0.0F, letter.c_str()).x + 5.0F * frame.scale;
    list.AddText(strong, plain->FontSize, {low.x, below}, to_u32(frame.theme.text), letter.c_str());
    list.AddText(plain, plain->FontSize, {low.x + indent, below}, to_u32(frame.theme.text),
                 cells_[i].caption.c_str(), nullptr, width - indent);
  }
}

}  // namespace stillpoint
