#include "ui/panels/frame_pictures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "core/inspect/frame_view.hpp"
#include "core/motion/methods.hpp"
#include "ui/gl/texture.hpp"
#include "ui/panels/panels_shared.hpp"
#include "ui/panels/run_series.hpp"
#include "ui/session/shown_runs.hpp"
#include "ui/theme/fonts.hpp"
#include "ui/theme/text.hpp"
#include "ui/view/picture_strips.hpp"

namespace stillpoint {
namespace {

cv::Vec3b to_bgr(Rgb colour) { return {colour.b, colour.g, colour.r}; }

cv::Vec4b to_bgra(Rgb colour, int alpha) {
  return {colour.b, colour.g, colour.r, static_cast<std::uint8_t>(alpha)};
}

/// @param image CV_8UC4, or a cover
cv::Rect part_not_transparent(const cv::Mat& image) {
  constexpr int kMargin = 8;  // px: at an eighth of its size one of its pixels is still seen that far away
  cv::Mat alpha = image;
  if (image.channels() == 4) cv::extractChannel(image, alpha, 3);
  const cv::Rect part = alpha.empty() ? cv::Rect() : cv::boundingRect(alpha);
  if (part.empty()) return part;
  const cv::Point margin(kMargin, kMargin);
  return cv::Rect(part.tl() - margin, part.br() + margin) & cv::Rect({}, image.size());
}

}  // namespace

FrameTexture::FrameTexture() : FrameTexture(Sampling::kPixels) {}
FrameTexture::FrameTexture(Sampling sampling) : sampling_(sampling), one_channel_(OneChannel::kGrey) {}
FrameTexture FrameTexture::cover() {
  FrameTexture texture;
  texture.one_channel_ = OneChannel::kCover;
  return texture;
}
FrameTexture::~FrameTexture() = default;
FrameTexture::FrameTexture(FrameTexture&&) noexcept = default;
FrameTexture& FrameTexture::operator=(FrameTexture&&) noexcept = default;

const Texture& FrameTexture::get(const UiFrame& frame, const std::shared_ptr<const FrameView>& view,
                                 int variant, const std::function<cv::Mat()>& make) {
  const bool same = !view_.owner_before(view) && !view.owner_before(view_);
  if (!texture_) texture_ = std::make_unique<Texture>(frame.gl, sampling_, one_channel_);
  if (same && variant_ == variant && theme_ == frame.theme.name) return *texture_;
  image_ = make();
  texture_->upload(image_);
  part_.reset();
  view_ = view;
  variant_ = variant;
  theme_ = frame.theme.name;
  return *texture_;
}

ImageOverlay FrameTexture::over(const UiFrame& frame, const std::shared_ptr<const FrameView>& view,
                                int variant, float opacity, Rgb colour,
                                const std::function<cv::Mat()>& make) {
  const Texture& texture = get(frame, view, variant, make);
  if (!part_) part_ = part_not_transparent(image_);
  return {&texture, opacity, colour, part_};
}

const cv::Mat& picture_of(const Frame& frame) { return frame.colour.empty() ? frame.gray : frame.colour; }

cv::Mat cover_of(const cv::Mat& mask) { return mask.empty() ? cv::Mat() : cv::Mat(mask != 0); }

cv::Mat plain_mask(const cv::Mat& mask, Rgb colour, Rgb ground) {
  if (mask.empty()) return {};
  cv::Mat plain(mask.size(), CV_8UC3, cv::Scalar(ground.b, ground.g, ground.r));
  plain.setTo(cv::Scalar(colour.b, colour.g, colour.r), mask);
  return plain;
}

cv::Mat coloured(const cv::Mat& values, const ColourScale& scale, bool zero_is_none) {
  if (values.empty()) return {};
  constexpr int kSteps = 512;  // colours of a scale: more than a channel's 256 levels tell apart
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
    std::vector<RasterPoint> outline;
    outline.reserve(contour.size());
    for (const cv::Point& point : contour) outline.push_back(to_raster(Eigen::Vector2d(point.x, point.y)));
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
    for (const RasterPoint& point : outline) points.push_back(response.to_screen(point));
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

void draw_image_alone(const UiFrame& frame, const SessionView& session, PanelActions& actions,
                      FrameTexture& texture, PanelsShared& shared, Footer footer) {
  // A row of controls and a line below stay free, so that the picture does not jump when they come.
  const float row = ImGui::GetFrameHeightWithSpacing();
  if (frame.controls) ImGui::Dummy({1.0F, ImGui::GetFrameHeight()});
  ImVec2 room = room_above(frame, footer);
  room.y = std::max(room.y, row);
  ImageContent content;
  content.texture =
      &texture.get(frame, session.current, -2, [&] { return picture_of(session.current->frame); });
  content.values = &session.current->frame.gray;
  draw_frame_image(frame, "image alone", content, shared, room, {session, actions});
  footer.draw(frame);
}

void draw_image_alone(const UiFrame& frame, const SessionView& session, PanelActions& actions,
                      FrameTexture& texture, PanelsShared& shared) {
  Footer footer;
  footer.legend.push_back({"mask and features follow", frame.theme.text_dim, Sign::kHollowSquare});
  footer.caption = fmt::format("{}: being worked out.", frame_text(session, session.current->frame));
  draw_image_alone(frame, session, actions, texture, shared, std::move(footer));
}

void draw_without(const UiFrame& frame, const SessionView& session, PanelActions& actions,
                  FrameTexture& texture, PanelsShared& shared, const std::string& why) {
  const bool in_strip = frame.strips != nullptr && frame.strips->pictures_alone();
  if (in_strip || !session.current->frame.readable()) {
    draw_absent(frame, why);
    return;
  }
  Footer footer;
  footer.caption = why;
  draw_image_alone(frame, session, actions, texture, shared, std::move(footer));
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
  if (view.motion && !view.motion->note.empty())
    return fmt::format("Method {} has no stages here: {}.", view.motion->method, view.motion->note);
  return view.record == nullptr ? fmt::format("Frame {} has not been processed yet.", view.index)
                                : fmt::format("Method {} has no stages here.", maker_of(session));
}

const StageLog* stages_or_absent(const UiFrame& frame, const SessionView& session, PanelActions& actions,
                                 const std::string& panel, const std::string& layer) {
  const FrameView& view = *session.current;
  if (const StageLog* log = stages_with(view, layer)) return log;
  if (!view.frame.readable()) {
    draw_absent(frame, missing_motion(session));
    return nullptr;
  }
  std::string text = missing_motion(session);
  Controls controls(frame);
  for (const MethodInfo& method : methods()) {
    if (std::find(method.panels.begin(), method.panels.end(), panel) == method.panels.end()) continue;
    const bool is_runs = session.outside.empty() && method.name == session.config.run.method;
    const bool beside = view.motion_beside && view.motion_beside->method == method.name;
    if (beside && !view.motion_beside->note.empty())
      text = fmt::format("Method {} has none here: {}.", method.name, view.motion_beside->note);
    if (is_runs || beside) continue;
    text = session.outside.empty()
               ? fmt::format("The run's method, {}, has no such stage.", session.config.run.method)
               : fmt::format("{} was run by another program, whose stages are not known.", session.outside);
    const std::string label = fmt::format("Lay {}'s beside", method.name);
    // Stages are laid beside those of the session's own run alone.
    if (session.own_run &&
        controls.button(label.c_str(),
                        "Works out that method's stages of each frame shown, beside the run's"))
      actions.requests.emplace_back(request::StagesBeside{method.name});
  }
  draw_absent(frame, text);
  return nullptr;
}

int round_shown(const StageLog& log, int chosen) {
  const int last = log.rounds() - 1;
  return chosen < 0 ? last : std::min(chosen, last);
}

std::string whose_stages(const SessionView& session, const StageLog& log) {
  if (&log != session.current->motion_beside.get()) return {};
  return fmt::format(" By method {}, laid beside; this run is by {}.", log.method, maker_of(session));
}

std::string same_in_all_runs(const UiFrame& frame) {
  const bool several = frame.runs != nullptr && frame.runs->pictures != RunPictures::alone;
  return several ? " The same in every run." : "";
}

std::string frame_text(const SessionView& session, const Frame& frame) {
  return fmt::format("Frame {}, {:.3f} s", frame.index, frame.timestamp - series_start(session));
}

}  // namespace stillpoint
