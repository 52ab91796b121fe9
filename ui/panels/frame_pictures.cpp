#include "ui/panels/frame_pictures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "ui/panels/run_series.hpp"

namespace stillpoint {
namespace {

cv::Vec3b to_bgr(Rgb colour) { return {colour.b, colour.g, colour.r}; }

cv::Vec4b to_bgra(Rgb colour, int alpha) {
  return {colour.b, colour.g, colour.r, static_cast<std::uint8_t>(alpha)};
}

}  // namespace

const Texture& FrameTexture::get(const UiFrame& frame, const std::shared_ptr<const FrameView>& view,
                                 int variant, const std::function<cv::Mat()>& make) {
  const bool same = !view_.owner_before(view) && !view.owner_before(view_);
  if (!texture_) texture_.emplace(frame.gl, sampling_);
  if (same && variant_ == variant && theme_ == frame.theme.name) return *texture_;
  image_ = make();
  texture_->upload(image_);
  view_ = view;
  variant_ = variant;
  theme_ = frame.theme.name;
  return *texture_;
}

const cv::Mat& picture_of(const Frame& frame) { return frame.colour.empty() ? frame.gray : frame.colour; }

cv::Mat tinted_mask(const cv::Mat& mask, Rgb colour) {
  if (mask.empty()) return {};
  // Transparent pixels carry the colour too, so that smoothing at a smaller size does not darken the edge.
  cv::Mat tinted(mask.size(), CV_8UC4, cv::Scalar(colour.b, colour.g, colour.r, 0));
  tinted.setTo(cv::Scalar(colour.b, colour.g, colour.r, 255), mask);
  return tinted;
}

cv::Mat plain_mask(const cv::Mat& mask, Rgb colour, Rgb ground) {
  if (mask.empty()) return {};
  cv::Mat plain(mask.size(), CV_8UC3, cv::Scalar(ground.b, ground.g, ground.r));
  plain.setTo(cv::Scalar(colour.b, colour.g, colour.r), mask);
  return plain;
}

cv::Mat coloured(const cv::Mat& values, const ColourScale& scale, bool zero_is_none) {
  if (values.empty()) return {};
  constexpr int kSteps = 512;
  std::array<cv::Vec3b, kSteps> table;
  for (int i = 0; i < kSteps; ++i) {
    const double share = static_cast<double>(i) / (kSteps - 1);
    table[static_cast<std::size_t>(i)] = to_bgr(scale.colour(scale.low + share * (scale.high - scale.low)));
  }
  const cv::Vec3b none = to_bgr(scale.none_colour);
  cv::Mat floats, picture(values.size(), CV_8UC3);
  values.convertTo(floats, CV_32F);
  const auto low = static_cast<float>(scale.low);
  const float steps_a_unit = (kSteps - 1) / static_cast<float>(scale.high - scale.low);
  for (int y = 0; y < values.rows; ++y) {
    const float* from = floats.ptr<float>(y);
    auto* to = picture.ptr<cv::Vec3b>(y);
    for (int x = 0; x < values.cols; ++x) {
      const float value = from[x];
      if (std::isnan(value) || (zero_is_none && value == 0.0F)) {
        to[x] = none;
      } else {
        const float step = std::clamp((value - low) * steps_a_unit, 0.0F, static_cast<float>(kSteps - 1));
        to[x] = table[static_cast<std::size_t>(step)];
      }
    }
  }
  return picture;
}

cv::Mat compared_masks(const cv::Mat& mask, const cv::Mat& truth, const ComparisonColours& colours) {
  if (truth.empty()) return {};
  constexpr int kPeriod = 12, kBroad = 5;  // px, of the hatching
  cv::Mat compared(truth.size(), CV_8UC4, cv::Scalar::all(0));
  for (int y = 0; y < truth.rows; ++y) {
    const auto* moves = truth.ptr<std::uint8_t>(y);
    const auto* found = mask.empty() ? nullptr : mask.ptr<std::uint8_t>(y);
    auto* to = compared.ptr<cv::Vec4b>(y);
    for (int x = 0; x < truth.cols; ++x) {
      const bool is_found = found != nullptr && found[x] != 0, is_moving = moves[x] != 0;
      const bool slash = (x + y) % kPeriod < kBroad;
      const bool backslash = (x - y + kPeriod * truth.rows) % kPeriod < kBroad;
      if (is_found && is_moving) to[x] = to_bgra(colours.agreed, 140);
      if (!is_found && is_moving) to[x] = to_bgra(colours.missed, slash ? 235 : 90);
      if (is_found && !is_moving) to[x] = to_bgra(colours.wrong, backslash ? 215 : 70);
    }
  }
  return compared;
}

Outlines outlines_of(const cv::Mat& mask) {
  Outlines outlines;
  if (mask.empty()) return outlines;
  std::vector<std::vector<cv::Point>> contours;
  cv::findContours(mask, contours, cv::RETR_CCOMP, cv::CHAIN_APPROX_SIMPLE);
  for (const auto& contour : contours) {
    std::vector<Eigen::Vector2d> outline;
    outline.reserve(contour.size());
    for (const cv::Point& point : contour) outline.emplace_back(point.x + 0.5, point.y + 0.5);
    outlines.push_back(std::move(outline));
  }
  return outlines;
}

void draw_outlines(const UiFrame& frame, const ImageResponse& response, const Outlines& outlines,
                   Rgb colour) {
  ImDrawList& list = *ImGui::GetWindowDrawList();
  std::vector<ImVec2> points;
  for (const auto& outline : outlines) {
    points.clear();
    for (const Eigen::Vector2d& point : outline) points.push_back(response.to_screen(point));
    list.AddPolyline(points.data(), static_cast<int>(points.size()), to_u32(colour), ImDrawFlags_Closed,
                     1.5F * frame.scale);
  }
}

void draw_heading(const UiFrame& frame, const ImageResponse& response, const std::string& heading) {
  if (heading.empty()) return;
  push_clip(response);
  const float gap = 5.0F * frame.scale;
  const ImFont* font = frame.fonts.small;
  const float room = response.panel_max.x - response.panel_min.x - 3.0F * gap;
  const auto fits = [&](const std::string& text) {
    return font->CalcTextSizeA(font->FontSize, 1e6F, 0.0F, text.c_str()).x <= room;
  };
  // What stands after a comma is a unit or a range: it goes first.
  std::string shown = heading;
  while (!fits(shown) && shown.find(',') != std::string::npos) shown.resize(shown.rfind(','));
  shown = cut_to(*font, shown, room);
  draw_label(frame, {response.panel_min.x + gap, response.panel_min.y + gap}, shown, frame.theme.text);
  pop_clip();
}

ImageResponse draw_frame_image(const UiFrame& frame, const char* id, const ImageContent& content,
                               PanelsShared& shared, ImVec2 size, const FramePlace& place,
                               const std::string& heading) {
  const ImageResponse response = draw_image(frame, id, content, shared.views.at("frame"), size);
  if (content.texture != nullptr && !content.texture->empty()) {
    take_mouse(id, response, shared, place);
    draw_marks(frame, response, shared, place);
  }
  draw_heading(frame, response, heading);
  return response;
}

ImageResponse draw_frame_image(const UiFrame& frame, const char* id, const ImageContent& content,
                               PanelsShared& shared, ImVec2 size, const std::string& heading) {
  const ImageResponse response = draw_image(frame, id, content, shared.views.at("frame"), size);
  if (response.pixel) {
    const Eigen::Vector2d pixel = response.pixel->cast<double>();
    shared.pixel = response.pixel;
    shared.cursor = ImageCursor{FrameSpace::kTarget, pixel, pixel};
  }
  draw_heading(frame, response, heading);
  return response;
}

ImageResponse draw_scaled_image(const UiFrame& frame, const char* id, const ImageContent& content,
                                PanelsShared& shared, ImVec2 size, const FramePlace& place,
                                const ColourScale& scale) {
  size.x -= colour_scale_width(frame) + ImGui::GetStyle().ItemSpacing.x;
  const ImageResponse response = draw_frame_image(frame, id, content, shared, size, place);
  ImGui::SameLine();
  draw_colour_scale(frame, scale, size.y);
  return response;
}

std::string missing_motion(const SessionView& session) {
  const FrameView& view = *session.current;
  if (!view.frame.readable()) {
    return view.frame.problem.empty()
               ? fmt::format("Frame {} has not been read yet.", view.index)
               : fmt::format("Frame {} cannot be shown: {}", view.index, view.frame.problem);
  }
  const int gap = session.config.motion.reference_gap;
  if (!view.reference.readable()) {
    if (view.index >= gap)
      return fmt::format("Frame {}, which this one is compared with, could not be read.", view.index - gap);
    if (view.index == 0) return "The first frame has none before it to be compared with.";
    return fmt::format("Frame {} has none {} frames before it to be compared with.", view.index, gap);
  }
  if (!view.motion.rounds.empty()) return {};
  if (!view.motion.note.empty()) return fmt::format("There is no motion mask: {}", view.motion.note);
  return "Motion has not been computed for this frame yet.";
}

bool draw_missing_motion(const UiFrame& frame, const SessionView& session) {
  const std::string missing = missing_motion(session);
  if (!missing.empty()) draw_absent(frame, missing);
  return !missing.empty();
}

int round_shown(const FrameView& view, int chosen) {
  const int last = static_cast<int>(view.motion.rounds.size()) - 1;
  return chosen < 0 ? last : std::min(chosen, last);
}

std::string whose_motion(const SessionView& session) {
  const std::string& method = session.config.run.method;
  if (method == "paper") return {};
  return fmt::format(" What the paper's method finds; this run is by {}.", method);
}

std::string frame_text(const SessionView& session, const Frame& frame) {
  return fmt::format("Frame {}, {:.3f} s", frame.index, frame.timestamp - series_start(session));
}

}  // namespace stillpoint
