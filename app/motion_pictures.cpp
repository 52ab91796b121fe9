#include "app/motion_pictures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "core/error.hpp"

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

constexpr int kFractionBits = 4;

cv::Point fixed_point(const cv::Point2f& point) {
  return {cvRound(point.x * (1 << kFractionBits)), cvRound(point.y * (1 << kFractionBits))};
}

void mark_circle(cv::Mat& image, const cv::Point2f& at, const cv::Scalar& colour) {
  cv::circle(image, fixed_point(at), 3 << kFractionBits, colour, 1, cv::LINE_AA, kFractionBits);
}

void mark_cross(cv::Mat& image, const cv::Point2f& at, const cv::Scalar& colour) {
  for (const cv::Point2f arm : {cv::Point2f(3, 3), cv::Point2f(3, -3)})
    cv::line(image, fixed_point(at - arm), fixed_point(at + arm), colour, 1, cv::LINE_AA, kFractionBits);
}

void mark_square(cv::Mat& image, const cv::Point2f& at, const cv::Scalar& colour) {
  const cv::Point2f half(3, 3);
  cv::rectangle(image, fixed_point(at - half), fixed_point(at + half), colour, 1, cv::LINE_AA, kFractionBits);
}

Marker marker(void (*mark)(cv::Mat&, const cv::Point2f&, const cv::Scalar&), const cv::Scalar& colour) {
  return [mark, colour](cv::Mat& image, const cv::Point2f& at) { mark(image, at, colour); };
}

Marker swatch(const cv::Scalar& colour) {
  return [colour](cv::Mat& image, const cv::Point2f& at) {
    cv::rectangle(image, cv::Rect(cvRound(at.x) - 6, cvRound(at.y) - 5, 12, 10), colour, cv::FILLED);
  };
}

/// The picture with a legend below it, as many lines as its width asks for.
cv::Mat with_legend(const cv::Mat& picture, const std::vector<LegendEntry>& entries) {
  constexpr int kLine = 20;
  constexpr double kTextScale = 0.42;
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
  cv::Mat gray, dim;
  if (image.channels() == 3) {
    cv::cvtColor(image, gray, cv::COLOR_BGR2GRAY);
  } else {
    gray = image;
  }
  cv::cvtColor(gray, dim, cv::COLOR_GRAY2BGR);
  return dim * 0.6;
}

void tint(cv::Mat& picture, const cv::Mat& where, const cv::Scalar& colour) {
  cv::Mat mixed;
  cv::addWeighted(picture, 0.45, cv::Mat(picture.size(), picture.type(), colour), 0.55, 0.0, mixed);
  mixed.copyTo(picture, where);
}

cv::Mat or_nothing(const cv::Mat& mask, const cv::Size& size) {
  return mask.empty() ? cv::Mat(cv::Mat::zeros(size, CV_8UC1)) : mask;
}

void write_picture(const std::filesystem::path& path, const cv::Mat& picture) {
  if (picture.empty()) return;
  bool written = false;
  try {
    written = cv::imwrite(path.string(), picture);
  } catch (const cv::Exception&) {
    written = false;
  }
  if (!written) throw InputError(fmt::format("{}: cannot be written", path.string()));
}

}  // namespace

cv::Mat draw_mask_overlay(const cv::Mat& colour, const MotionRound& round) {
  cv::Mat picture = colour.clone();
  if (!round.mask.empty()) {
    const cv::Mat forward = or_nothing(round.forward.mask, colour.size());
    const cv::Mat backward = or_nothing(round.backward_mask_in_target, colour.size());
    tint(picture, forward & ~backward, kOrange);
    tint(picture, backward & ~forward, kBlue);
    tint(picture, forward & backward, kVermilion);
    for (const MotionRegion& region : round.regions) {
      cv::rectangle(picture, region.box, kBlack, 3);
      cv::rectangle(picture, region.box, kWhite, 1);
    }
  }
  const std::string share =
      fmt::format("{} regions, {:.1f} % of the frame", round.regions.size(), 100.0 * round.mask_share);
  return with_legend(picture, {{"both directions", swatch(kVermilion)},
                               {"forward only", swatch(kOrange)},
                               {"backward only", swatch(kBlue)},
                               {share, [](cv::Mat&, const cv::Point2f&) {}}});
}

cv::Mat draw_tracks(const cv::Mat& destination, const DirectionTrace& direction) {
  cv::Mat picture = dimmed(destination);
  int inliers = 0, outliers = 0, removed = 0;
  for (const Track& track : direction.tracks) {
    const cv::Scalar& colour = track.removed ? kVermilion : track.inlier ? kGreen : kYellow;
    cv::line(picture, fixed_point(track.from), fixed_point(track.to), colour, 1, cv::LINE_AA, kFractionBits);
    if (track.removed) {
      mark_square(picture, track.to, colour);
      ++removed;
    } else if (track.inlier) {
      mark_circle(picture, track.to, colour);
      ++inliers;
    } else {
      mark_cross(picture, track.to, colour);
      ++outliers;
    }
  }
  return with_legend(picture, {{fmt::format("{} inliers", inliers), marker(mark_circle, kGreen)},
                               {fmt::format("{} outliers", outliers), marker(mark_cross, kYellow)},
                               {fmt::format("{} removed", removed), marker(mark_square, kVermilion)}});
}

cv::Mat draw_features(const cv::Mat& colour, const MotionRound& round) {
  cv::Mat picture = dimmed(colour);
  int kept = 0, removed = 0;
  for (const Track& track : round.forward.tracks) {
    const bool moving =
        !round.mask.empty() && round.mask.at<unsigned char>(cvRound(track.to.y), cvRound(track.to.x)) != 0;
    if (moving) {
      mark_square(picture, track.to, kVermilion);
      ++removed;
    } else {
      mark_circle(picture, track.to, kGreen);
      ++kept;
    }
  }
  return with_legend(picture, {{fmt::format("{} kept", kept), marker(mark_circle, kGreen)},
                               {fmt::format("{} removed", removed), marker(mark_square, kVermilion)}});
}

void remove_round_pictures(const std::filesystem::path& folder) {
  std::error_code ignored;
  for (const char* direction : {"forward", "backward"})
    for (const char* kind : {"compensated", "difference", "raw_mask", "mask", "tracks"})
      std::filesystem::remove(folder / fmt::format("{}_{}.png", kind, direction), ignored);
  for (const char* name : {"mask_backward_in_target.png", "mask_union.png", "overlay.png", "features.png"})
    std::filesystem::remove(folder / name, ignored);
}

void write_round_pictures(const std::filesystem::path& folder, const MotionRound& round,
                          const cv::Mat& reference, const cv::Mat& target) {
  const auto write_direction = [&](const DirectionTrace& direction, const std::string& name,
                                   const cv::Mat& destination) {
    write_picture(folder / ("compensated_" + name + ".png"), direction.compensated);
    write_picture(folder / ("difference_" + name + ".png"), direction.difference);
    write_picture(folder / ("raw_mask_" + name + ".png"), direction.raw_mask);
    write_picture(folder / ("mask_" + name + ".png"), direction.mask);
    write_picture(folder / ("tracks_" + name + ".png"), draw_tracks(destination, direction));
  };
  write_direction(round.forward, "forward", target);
  write_direction(round.backward, "backward", reference);
  write_picture(folder / "mask_backward_in_target.png", round.backward_mask_in_target);
  write_picture(folder / "mask_union.png", round.mask);
  write_picture(folder / "overlay.png", draw_mask_overlay(target, round));
  write_picture(folder / "features.png", draw_features(target, round));
}

}  // namespace stillpoint
