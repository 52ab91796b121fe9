#include "app/motion_colour.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <system_error>

#include "core/error.hpp"

namespace stillpoint {
namespace {

constexpr const char* kPictures[] = {"mask.png", "evidence.png", "points.png", "overlay.png"};

// BGR, of Okabe & Ito's palette: told apart without red and green.
const cv::Scalar kVermilion(0, 94, 213), kBlue(233, 180, 86), kWhite(255, 255, 255), kBlack(0, 0, 0);

void write_picture(const std::filesystem::path& path, const cv::Mat& picture) {
  bool written = false;
  try {
    written = !picture.empty() && cv::imwrite(path.string(), picture);
  } catch (const cv::Exception&) {
    written = false;
  }
  if (!written) throw InputError(fmt::format("{}: cannot be written", path.string()));
}

int moving_points(const EpipolarTrace& trace, const EpipolarConfig& config) {
  return static_cast<int>(
      std::count_if(trace.points.begin(), trace.points.end(), [&config](const ColourPoint& point) {
        return point.age >= config.min_age && point.shared > static_cast<float>(config.moving_evidence);
      }));
}

cv::Mat draw_points(const cv::Mat& frame, const EpipolarTrace& trace, const EpipolarConfig& config) {
  cv::Mat picture = frame * 0.5;
  for (const ColourPoint& point : trace.points) {
    if (point.age < config.min_age) continue;
    if (point.shared > static_cast<float>(config.moving_evidence)) {
      cv::rectangle(picture, cv::Rect(cvRound(point.at.x) - 3, cvRound(point.at.y) - 3, 7, 7), kVermilion, 1);
    } else {
      cv::circle(picture, point.at, 2, kBlue, 1, cv::LINE_AA);
    }
  }
  return picture;
}

cv::Mat draw_overlay(const cv::Mat& frame, const EpipolarTrace& trace) {
  cv::Mat picture = frame.clone(), mixed;
  cv::addWeighted(picture, 0.45, cv::Mat(picture.size(), picture.type(), kVermilion), 0.55, 0.0, mixed);
  mixed.copyTo(picture, trace.mask);
  std::vector<std::vector<cv::Point>> outlines;
  cv::findContours(trace.mask, outlines, cv::RETR_EXTERNAL, cv::CHAIN_APPROX_NONE);
  cv::drawContours(picture, outlines, -1, kBlack, 3);
  cv::drawContours(picture, outlines, -1, kWhite, 1);
  return picture;
}

}  // namespace

std::string colour_motion_csv_heading() {
  return "target,points,moving_points,references,turns_only,sigma_px,explained,mask_share,regions,"
         "largest_region_px,note";
}

std::string colour_motion_csv_row(int index, const EpipolarTrace& trace, const EpipolarConfig& config) {
  std::string row = fmt::format("{},{},{},{}", index, trace.points.size(), moving_points(trace, config),
                                trace.references.size());
  if (trace.references.empty()) {
    row += ",,,";
  } else {
    const ColourReference& last = trace.references.back();
    row += fmt::format(",{},{:.4f},{:.4f}", last.motion.turns_only ? 1 : 0, 2.0 * last.sigma,
                       last.motion.explained);
  }
  int largest = 0;
  for (const MotionRegion& region : trace.regions) largest = std::max(largest, region.area);
  row += trace.mask.empty() ? std::string(",,,")
                            : fmt::format(",{:.6f},{},{}", trace.mask_share, trace.regions.size(), largest);
  return row + fmt::format(",\"{}\"", trace.note);
}

nlohmann::json colour_motion_json(int index, const EpipolarTrace& trace, const EpipolarConfig& config) {
  nlohmann::json references = nlohmann::json::array(), regions = nlohmann::json::array();
  for (const ColourReference& reference : trace.references)
    references.push_back({{"gap", reference.gap},
                          {"points", reference.points.size()},
                          {"turns_only", reference.motion.turns_only},
                          {"sigma_px", 2.0 * reference.sigma},
                          {"explained", reference.motion.explained}});
  for (const MotionRegion& region : trace.regions)
    regions.push_back({{"x", region.box.x},
                       {"y", region.box.y},
                       {"width", region.box.width},
                       {"height", region.box.height},
                       {"area_px", region.area}});
  return {{"target", index},
          {"points", trace.points.size()},
          {"moving_points", moving_points(trace, config)},
          {"references", references},
          {"mask_share", trace.mask.empty() ? nlohmann::json() : nlohmann::json(trace.mask_share)},
          {"regions", regions},
          {"note", trace.note}};
}

void write_colour_motion_pictures(const std::filesystem::path& folder, const EpipolarTrace& trace,
                                  const cv::Mat& frame, const EpipolarConfig& config) {
  write_picture(folder / "points.png", draw_points(frame, trace, config));
  if (trace.mask.empty()) return;
  write_picture(folder / "mask.png", trace.mask);
  cv::Mat evidence;
  trace.evidence.convertTo(evidence, CV_8UC1, 127.0, 128.0);  // grey is none; -1 black, 1 white
  cv::resize(evidence, evidence, frame.size(), 0, 0, cv::INTER_NEAREST);
  write_picture(folder / "evidence.png", evidence);
  write_picture(folder / "overlay.png", draw_overlay(frame, trace));
}

void remove_colour_motion_pictures(const std::filesystem::path& folder) {
  std::error_code ignored;
  for (const char* name : kPictures) std::filesystem::remove(folder / name, ignored);
}

}  // namespace stillpoint
