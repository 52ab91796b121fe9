#include "app/layer_pictures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <opencv2/imgproc.hpp>

#include "core/error.hpp"
#include "core/media/image_codec.hpp"

namespace stillpoint {
namespace {

// BGR; told apart without red and green (Okabe & Ito's palette), and never by colour alone where shapes can
// differ.
const cv::Scalar kOrange(0, 159, 230), kBlue(233, 180, 86), kVermilion(0, 94, 213), kGreen(115, 158, 0),
    kYellow(66, 228, 240), kWhite(255, 255, 255), kBlack(0, 0, 0);

using Marker = std::function<void(cv::Mat&, const cv::Point2f&)>;

struct LegendEntry {
  std::string text;
  Marker draw;
};

constexpr int kFractionBits = 4;  // a sixteenth of a pixel: smooth lines show no more

cv::Point fixed_point(const cv::Point2f& point) {
  return {cvRound(point.x * (1 << kFractionBits)), cvRound(point.y * (1 << kFractionBits))};
}

void draw_circle(cv::Mat& image, const cv::Point2f& at, const cv::Scalar& colour) {
  cv::circle(image, fixed_point(at), 3 << kFractionBits, colour, 1, cv::LINE_AA, kFractionBits);
}

void draw_cross(cv::Mat& image, const cv::Point2f& at, const cv::Scalar& colour) {
  for (const cv::Point2f arm : {cv::Point2f(3, 3), cv::Point2f(3, -3)})
    cv::line(image, fixed_point(at - arm), fixed_point(at + arm), colour, 1, cv::LINE_AA, kFractionBits);
}

void draw_square(cv::Mat& image, const cv::Point2f& at, const cv::Scalar& colour) {
  const cv::Point2f half(3, 3);
  cv::rectangle(image, fixed_point(at - half), fixed_point(at + half), colour, 1, cv::LINE_AA, kFractionBits);
}

/// How a kind of mark is drawn, and what the legend calls many of it.
struct MarkStyle {
  MarkKind kind;
  const char* plural;
  void (*draw)(cv::Mat&, const cv::Point2f&, const cv::Scalar&);
  const cv::Scalar& colour;
};

const std::array<MarkStyle, 7> kMarkStyles = {{{MarkKind::kInlier, "inliers", draw_circle, kGreen},
                                               {MarkKind::kOutlier, "outliers", draw_cross, kYellow},
                                               {MarkKind::kKept, "kept", draw_circle, kGreen},
                                               {MarkKind::kRemoved, "removed", draw_square, kVermilion},
                                               {MarkKind::kUnmatched, "unmatched", draw_cross, kWhite},
                                               {MarkKind::kGained, "gained", draw_circle, kBlue},
                                               {MarkKind::kLost, "lost", draw_square, kOrange}}};

Marker swatch(const cv::Scalar& colour) {
  return [colour](cv::Mat& image, const cv::Point2f& at) {
    cv::rectangle(image, cv::Rect(cvRound(at.x) - 6, cvRound(at.y) - 5, 12, 10), colour, cv::FILLED);
  };
}

/// The picture with a legend below it, as many lines as its width asks for.
cv::Mat with_legend(const cv::Mat& picture, const std::vector<LegendEntry>& entries) {
  constexpr int kLine = 20;            // px of a line of text
  constexpr double kTextScale = 0.42;  // of OpenCV's font: 9 px a capital
  std::vector<cv::Point> places;
  int x = 4, y = 0;
  for (const LegendEntry& entry : entries) {
    const int width =
        40 + cv::getTextSize(entry.text, cv::FONT_HERSHEY_SIMPLEX, kTextScale, 1, nullptr).width;
    if (x > 4 && x + width > picture.cols) {
      x = 4;
      y += kLine;
    }
    places.emplace_back(x, y);
    x += width;
  }
  cv::Mat strip(y + kLine, picture.cols, CV_8UC3, cv::Scalar(32, 32, 32));
  for (std::size_t i = 0; i < entries.size(); ++i) {
    entries[i].draw(strip,
                    {static_cast<float>(places[i].x + 10), static_cast<float>(places[i].y + kLine / 2)});
    cv::putText(strip, entries[i].text, places[i] + cv::Point(22, 14), cv::FONT_HERSHEY_SIMPLEX, kTextScale,
                kWhite, 1, cv::LINE_AA);
  }
  cv::Mat whole;
  cv::vconcat(picture, strip, whole);
  return whole;
}

/// Colour brought back towards grey and dark, so that marks stand out.
cv::Mat dimmed(const cv::Mat& image) {
  cv::Mat gray = image, dim;
  if (image.channels() == 3) cv::cvtColor(image, gray, cv::COLOR_BGR2GRAY);
  cv::cvtColor(gray, dim, cv::COLOR_GRAY2BGR);
  return dim * 0.6;
}

cv::Mat draw_marks(const cv::Mat& ground, const Layer& layer) {
  cv::Mat picture = dimmed(ground);
  std::array<int, kMarkStyles.size()> counts{};
  for (const Mark& mark : layer.marks) {
    const auto* style = std::find_if(kMarkStyles.begin(), kMarkStyles.end(),
                                     [&mark](const MarkStyle& one) { return one.kind == mark.kind; });
    if (mark.from)
      cv::line(picture, fixed_point(*mark.from), fixed_point(mark.at), style->colour, 1, cv::LINE_AA,
               kFractionBits);
    style->draw(picture, mark.at, style->colour);
    ++counts[static_cast<std::size_t>(style - kMarkStyles.begin())];
  }
  std::vector<LegendEntry> legend;
  for (std::size_t i = 0; i < kMarkStyles.size(); ++i) {
    const MarkStyle& style = kMarkStyles[i];
    if (counts[i] > 0)
      legend.push_back(
          {fmt::format("{} {}", counts[i],
                       layer.words.contains(style.kind) ? layer.word_of(style.kind) : style.plural),
           [&style](cv::Mat& image, const cv::Point2f& at) { style.draw(image, at, style.colour); }});
  }
  return with_legend(picture, legend);
}

/// CV_32FC1 as 8 bits, linearly on each side of 0. @param below,above grey levels of one unit there
cv::Mat as_levels(const cv::Mat& values, float zero, float below, float above) {
  cv::Mat levels(values.size(), CV_8UC1);
  for (int y = 0; y < values.rows; ++y) {
    const auto* from = values.ptr<float>(y);
    auto* to = levels.ptr<std::uint8_t>(y);
    for (int x = 0; x < values.cols; ++x) {
      const float value = std::isnan(from[x]) ? 0.0F : from[x];
      to[x] = static_cast<std::uint8_t>(
          std::lround(std::clamp(zero + value * (value < 0.0F ? below : above), 0.0F, 255.0F)));
    }
  }
  return levels;
}

cv::Mat values_as_levels(const Layer& layer) {
  const auto range = static_cast<float>(layer.range > 0.0 ? layer.range : 1.0);
  switch (layer.kind) {
    case LayerKind::kSigned:
      return as_levels(layer.image, 128.0F, 128.0F / range, 127.0F / range);
    case LayerKind::kLength:
      return as_levels(layer.image, 0.0F, 255.0F / range, 255.0F / range);
    default:
      return as_levels(layer.image, 0.0F, 1.0F, 1.0F);
  }
}

/// The highest number white.
cv::Mat classes_as_levels(const Layer& layer) {
  cv::Mat levels;
  layer.image.convertTo(levels, CV_8U, 255.0 / std::max(layer.range, 1.0));
  return levels;
}

void tint(cv::Mat& picture, const cv::Mat& where, const cv::Scalar& colour) {
  cv::Mat mixed;
  cv::addWeighted(picture, 0.45, cv::Mat(picture.size(), picture.type(), colour), 0.55, 0.0, mixed);
  mixed.copyTo(picture, where);
}

}  // namespace

cv::Mat draw_layer(const Layer& layer) {
  if (layer.image.empty()) return {};
  const cv::Mat image = layer.image.type() == CV_32FC1      ? values_as_levels(layer)
                        : layer.kind == LayerKind::kClasses ? classes_as_levels(layer)
                                                            : layer.image;
  return layer.marks.empty() ? image : draw_marks(image, layer);
}

cv::Mat draw_mask_overlay(const cv::Mat& colour, const cv::Mat& mask,
                          const std::vector<MotionRegion>& regions, const cv::Mat& partial,
                          const std::string& partial_name) {
  cv::Mat picture = colour.clone();
  std::vector<LegendEntry> legend;
  if (partial.empty()) {
    tint(picture, mask, kVermilion);
    legend.push_back({"dynamic", swatch(kVermilion)});
  } else {
    tint(picture, mask & partial, kVermilion);
    tint(picture, mask & ~partial, kBlue);
    legend.push_back({partial_name, swatch(kVermilion)});
    legend.push_back({"the rest of the mask", swatch(kBlue)});
  }
  for (const MotionRegion& region : regions) {
    cv::rectangle(picture, region.box, kBlack, 3);
    cv::rectangle(picture, region.box, kWhite, 1);
  }
  const double share = static_cast<double>(cv::countNonZero(mask)) / static_cast<double>(mask.total());
  legend.push_back({fmt::format("{} region{}, {:.1f} % of the frame", regions.size(),
                                regions.size() == 1 ? "" : "s", 100.0 * share),
                    [](cv::Mat&, const cv::Point2f&) {}});
  return with_legend(picture, legend);
}

void write_picture(const std::filesystem::path& path, const cv::Mat& picture) {
  bool written = false;
  try {
    written = !picture.empty() && save_image(path, picture);
  } catch (const cv::Exception&) {
    written = false;
  }
  if (!written) throw InputError(fmt::format("{}: cannot be written", path.string()));
}

}  // namespace stillpoint
