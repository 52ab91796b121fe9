#include "ui/panels/stage_drawing.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "core/geometry/pixel_conventions.hpp"
#include "ui/panels/panels_shared.hpp"
#include "ui/theme/colormap.hpp"

namespace stillpoint {
namespace {

constexpr Rgb kGainedColour = okabe_ito::kSkyBlue, kLostColour = okabe_ito::kVermillion,
              kStaysColour = okabe_ito::kGreen, kWhite = {255, 255, 255};
constexpr double kClassesTold = 8.0;  // as many as there are colours

struct MarkLook {
  Rgb colour;
  Sign sign = Sign::kCircle;
};

MarkLook look_of(MarkKind kind, ThemeName theme) {
  switch (kind) {
    case MarkKind::kInlier:
      return {role_colour(Role::kInlier, theme), Sign::kCircle};
    case MarkKind::kOutlier:
      return {role_colour(Role::kOutlier, theme), Sign::kTriangle};
    case MarkKind::kRemoved:
      return {role_colour(Role::kRemoved, theme), Sign::kCross};
    case MarkKind::kKept:
      return {role_colour(Role::kKept, theme), Sign::kCircle};
    case MarkKind::kUnmatched:
      return {okabe_ito::kSkyBlue, Sign::kRing};
    case MarkKind::kGained:
      return {kGainedColour, Sign::kCircle};
    case MarkKind::kLost:
      return {kLostColour, Sign::kCross};
  }
  return {};
}

/// The colour of a class; of more than there are colours, by its number alone.
Rgb class_colour(int number, double count) {
  constexpr std::array kColours{
      okabe_ito::kSkyBlue, okabe_ito::kOrange,     okabe_ito::kGreen, okabe_ito::kYellow,
      okabe_ito::kPurple,  okabe_ito::kVermillion, okabe_ito::kBlue,  kWhite};
  if (count > kClassesTold) return map_colour(Colormap::kViridis, static_cast<float>(number / count));
  return kColours[static_cast<std::size_t>(number - 1) % kColours.size()];
}

ColourScale scale_of(const UiFrame& frame, const Layer& picture) {
  ColourScale scale;
  scale.high = picture.range;
  scale.none_colour = no_value_colour(frame.theme);
  const double range = std::max(picture.range, 1e-9);
  if (picture.kind == LayerKind::kSigned) {
    scale.low = -picture.range;
    scale.colour = [&theme = frame.theme, range](double v) { return diverging_colour(theme, v / range); };
  } else if (picture.kind == LayerKind::kLength) {
    scale.colour = [range](double v) {
      return map_colour(Colormap::kViridis, static_cast<float>(1.0 - v / range));
    };
  } else if (picture.kind == LayerKind::kClasses) {
    scale.colour = [range, none = scale.none_colour](double v) {
      const auto number = static_cast<int>(std::lround(v));
      return number < 1 ? none : class_colour(number, range);
    };
  } else {
    scale.colour = [range](double v) {
      return map_colour(Colormap::kInferno, static_cast<float>(v / range));
    };
  }
  return scale;
}

/// A photo as a texture takes it; grey levels as floats, with gaps, as well.
cv::Mat as_picture(const UiFrame& frame, const cv::Mat& image) {
  if (image.depth() != CV_32F) return image;
  ColourScale grey;
  grey.high = 255.0;
  grey.none_colour = no_value_colour(frame.theme);
  grey.colour = [](double v) {
    const auto level = static_cast<std::uint8_t>(v);
    return Rgb{level, level, level};
  };
  return coloured(image, grey);
}

cv::Mat changes(const cv::Mat& image) {
  std::array<cv::Vec4b, 256> looks{};
  const auto look = [&](MaskChange kind, Rgb colour, std::uint8_t alpha) {
    looks[kind] = {colour.b, colour.g, colour.r, alpha};
  };
  look(kStays, kStaysColour, 110);
  look(kGained, kGainedColour, 225);
  look(kLost, kLostColour, 225);
  cv::Mat picture(image.size(), CV_8UC4);
  for (int y = 0; y < image.rows; ++y) {
    const auto* kinds = image.ptr<std::uint8_t>(y);
    std::transform(kinds, kinds + image.cols, picture.ptr<cv::Vec4b>(y),
                   [&](std::uint8_t kind) { return looks[kind]; });
  }
  return picture;
}

void draw_dots(const UiFrame& frame, const ImageResponse& response, const std::vector<Mark>& dots) {
  ImDrawList& list = *ImGui::GetWindowDrawList();
  // Small pictures get smaller signs.
  const float size = std::clamp(static_cast<float>(response.map.scale()) * 3.6F, 1.3F, 3.0F) * frame.scale;
  for (const Mark& dot : dots) {
    const MarkLook look = look_of(dot.kind, frame.theme.name);
    const ImVec2 at = response.to_screen(to_raster(dot.at));
    if (dot.from)
      list.AddLine(response.to_screen(to_raster(dot.at + 2.0F * (*dot.from - dot.at))), at,
                   to_u32(look.colour, 0.8F), 0.45F * size);
    draw_sign(frame, list, at, look.sign == Sign::kCircle ? 0.8F * size : size, look.sign,
              to_u32(look.colour));
  }
}

}  // namespace

void StagePainter::draw(const UiFrame& frame, const char* id, const Layer& picture, int variant,
                        PanelsShared& shared, const FramePlace& place, ImVec2 size) {
  ImageContent content;
  content.absent = "There is none.";
  content.values = &picture.image;
  const auto& view = place.session.current;
  const bool over = picture.kind == LayerKind::kMask || picture.kind == LayerKind::kMaskChange;
  if (!picture.image.empty()) {
    content.texture = &ground_.get(frame, view, variant, [&] {
      if (over) return as_picture(frame, picture.ground);
      return picture.kind == LayerKind::kPhoto
                 ? as_picture(frame, picture.image)
                 : coloured(picture.image, scale_of(frame, picture), picture.kind == LayerKind::kLength);
    });
    if (over) {
      content.overlays.push_back(
          picture.kind == LayerKind::kMask
              ? over_.over(frame, view, variant, 0.55F, role_colour(Role::kUnion, frame.theme.name),
                           [&] { return cover_of(picture.image); })
              : over_.over(frame, view, variant, 1.0F, kWhite, [&] { return changes(picture.image); }));
    }
  }
  std::string heading = picture.name;
  if (picture.kind == LayerKind::kSigned) heading += fmt::format(", ±{:.3g} {}", picture.range, picture.unit);
  if (picture.kind == LayerKind::kLevels || picture.kind == LayerKind::kLength)
    heading += fmt::format(", 0 to {:.3g} {}", picture.range, picture.unit);
  if (picture.elsewhere) {
    const ImageResponse response = draw_image(frame, id, content, shared.views.at("frame"), size);
    draw_heading(frame, response, heading);
    return;
  }
  const ImageResponse response = draw_frame_image(frame, id, content, shared, size,
                                                  {place.session, place.actions, picture.space}, heading);
  push_clip(response);
  draw_dots(frame, response, picture.marks);
  pop_clip();
}

std::vector<LegendEntry> legend_of(const UiFrame& frame, const Layer& picture) {
  std::vector<LegendEntry> legend;
  if (picture.kind == LayerKind::kMask)
    legend.push_back({"in the mask", role_colour(Role::kUnion, frame.theme.name), Sign::kSquare});
  if (picture.kind == LayerKind::kMaskChange) {
    legend.push_back({"gained", kGainedColour, Sign::kSquare});
    legend.push_back({"lost", kLostColour, Sign::kSquare});
    legend.push_back({"stays", kStaysColour, Sign::kSquare});
  }
  if (picture.kind == LayerKind::kSigned) {
    legend.push_back({"above 0", diverging_colour(frame.theme, 1.0), Sign::kSquare});
    legend.push_back({"below 0", diverging_colour(frame.theme, -1.0), Sign::kSquare});
  }
  if (picture.kind == LayerKind::kClasses && picture.range <= kClassesTold)
    for (int number = 1; number <= static_cast<int>(picture.range); ++number)
      if (cv::countNonZero(picture.image == number) > 0)
        legend.push_back({std::to_string(number), class_colour(number, picture.range), Sign::kSquare});
  std::set<MarkKind> kinds;
  for (const Mark& dot : picture.marks) kinds.insert(dot.kind);
  for (const MarkKind kind : kinds) {
    const MarkLook look = look_of(kind, frame.theme.name);
    legend.push_back({picture.word_of(kind), look.colour, look.sign});
  }
  return legend;
}

}  // namespace stillpoint
