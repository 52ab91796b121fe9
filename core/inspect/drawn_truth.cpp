#include "core/inspect/drawn_truth.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <opencv2/imgproc.hpp>

#include "core/counted.hpp"
#include "core/error.hpp"
#include "core/evaluation/mask_scores.hpp"
#include "core/inspect/mask_carrying.hpp"
#include "core/media/image_codec.hpp"
#include "core/out_folder.hpp"
#include "core/run/condition.hpp"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;

constexpr const char* kList = "mask.txt";
constexpr const char* kFolder = "mask";
constexpr const char* kNewFolder = "mask.part";
constexpr double kLeastDrawn = 60.0;                   // px²: less is nothing one would draw
constexpr std::string_view kSign = "# truth by hand";  // begins a list of ours

/// Carries masks from drawn frame to drawn frame.
class Carrier {
 public:
  using Take = std::function<void(int, const cv::Mat&)>;

  Carrier(const FrameSource& source, const Take& take, const ExportControl& control)
      : source_(source), take_(take), control_(control) {}

  CarriedTruth carry(const std::vector<DrawnFrame>& drawn) {
    if (drawn.empty()) throw InputError(fmt::format("{}: no frame has been drawn yet", source_.name()));
    for (const DrawnFrame& one : drawn) {
      const Frame frame = source_.read(one.frame);
      if (!frame.readable())
        throw InputError(
            fmt::format("{}: frame {}, which was drawn, cannot be read", source_.name(), one.frame));
      masks_[one.frame] = mask_of_outlines(one.movers, frame.gray.size());
      give(one.frame, masks_[one.frame]);
      ++result_.drawn;
    }
    carry_out(drawn.front().frame, -1, -1);
    for (std::size_t i = 1; i < drawn.size() && !stopped(); ++i)
      fill_between(drawn[i - 1].frame, drawn[i].frame);
    carry_out(drawn.back().frame, source_.size(), 1);
    std::sort(result_.unreadable.begin(), result_.unreadable.end());
    return std::move(result_);
  }

  [[nodiscard]] bool stopped() const { return control_.stop != nullptr && *control_.stop; }

 private:
  /// From a drawn frame towards another that is not drawn, or beyond it. @returns the masks of the frames on
  /// the way, and of the end where it can be read; those that cannot be read have none
  std::map<int, cv::Mat> chain(int from, int end, int step) {
    std::map<int, cv::Mat> masks;
    Frame last = source_.read(from);
    cv::Mat mask = masks_.at(from);
    for (int at = from + step; at != end + step && at >= 0 && at < source_.size() && !stopped(); at += step) {
      Frame frame = source_.read(at);
      if (!frame.readable()) continue;
      mask = carried_mask(last, mask, frame);
      masks[at] = mask;
      last = std::move(frame);
    }
    return masks;
  }

  void carry_out(int from, int end, int step) {
    const std::map<int, cv::Mat> masks = chain(from, end - step, step);
    for (int at = from + step; at != end && !stopped(); at += step) take_or_miss(at, masks);
  }

  void fill_between(int first, int last) {
    std::map<int, cv::Mat> onwards = chain(first, last, 1), backwards = chain(last, first, -1);
    score(first, last, onwards), score(last, first, backwards);
    std::map<int, cv::Mat> masks;
    for (const auto& [at, mask] : onwards)
      if (const auto other = backwards.find(at); other != backwards.end())
        masks[at] = blended_mask(mask, other->second,
                                 static_cast<double>(at - first) / static_cast<double>(last - first));
    for (int at = first + 1; at < last && !stopped(); ++at) take_or_miss(at, masks);
  }

  void score(int from, int to, const std::map<int, cv::Mat>& masks) {
    const auto carried = masks.find(to);
    if (carried == masks.end()) return;
    if (const auto iou = score_mask(carried->second, masks_.at(to)).iou())
      result_.scores.push_back({from, to, *iou});
  }

  void take_or_miss(int at, const std::map<int, cv::Mat>& masks) {
    if (const auto mask = masks.find(at); mask != masks.end()) {
      give(at, mask->second);
      ++result_.carried;
    } else {
      result_.unreadable.push_back(at);
    }
  }

  void give(int at, const cv::Mat& mask) {
    take_(at, mask);
    ++given_;
    if (control_.progress) control_.progress("masks", given_, source_.size());
  }

  const FrameSource& source_;
  const Take& take_;
  const ExportControl& control_;
  std::map<int, cv::Mat> masks_;  // drawn
  CarriedTruth result_;
  int given_ = 0;
};

/// An InputError in place of what the file system says.
template <typename Work>
auto in_folder(const fs::path& folder, const Work& work) {
  try {
    return work();
  } catch (const fs::filesystem_error& error) {
    throw InputError(fmt::format("{}: cannot be written: {}", folder.string(), error.code().message()));
  }
}

std::string list_text(const FrameSource& source, const std::vector<DrawnFrame>& drawn,
                      const std::map<int, std::string>& names) {
  std::vector<int> frames;
  for (const DrawnFrame& one : drawn) frames.push_back(one.frame);
  std::string text =
      fmt::format("{}, drawn on frames {}; carried to the others by flow and depth. 255 = moving\n", kSign,
                  frames_text(frames));
  for (const auto& [index, name] : names) {
    const double stamp = source.timestamp(index) - source.camera().stamp_delay_s;
    text += fmt::format("{:.6f} {}/{}\n", stamp, kFolder, name);
  }
  return text;
}

}  // namespace

cv::Mat mask_of_outlines(const std::vector<Outline>& movers, cv::Size size) {
  constexpr int kShift = 4;  // bits behind the point
  cv::Mat mask = cv::Mat::zeros(size, CV_8UC1);
  for (const Outline& outline : movers) {
    std::vector<cv::Point> corners;
    for (const Corner& corner : outline)
      corners.emplace_back(cvRound(corner.x * (1 << kShift)), cvRound(corner.y * (1 << kShift)));
    cv::fillPoly(mask, std::vector<std::vector<cv::Point>>{corners}, 255, cv::LINE_8, kShift);
  }
  return mask;
}

std::vector<Outline> outlines_of_mask(const cv::Mat& mask) {
  constexpr double kExact = 1.5;  // px from the mask's edge: few corners are easier to correct
  std::vector<std::vector<cv::Point>> contours;
  cv::findContours(mask.clone(), contours, cv::RETR_EXTERNAL, cv::CHAIN_APPROX_NONE);
  std::erase_if(contours, [](const auto& contour) { return cv::contourArea(contour) < kLeastDrawn; });
  std::stable_sort(contours.begin(), contours.end(),
                   [](const auto& a, const auto& b) { return cv::contourArea(a) > cv::contourArea(b); });
  std::vector<Outline> outlines;
  for (const auto& contour : contours) {
    std::vector<cv::Point> corners;
    cv::approxPolyDP(contour, corners, kExact, true);
    if (corners.size() < 3) continue;
    Outline& outline = outlines.emplace_back();
    for (const cv::Point& p : corners)
      outline.push_back({static_cast<double>(p.x), static_cast<double>(p.y)});
  }
  return outlines;
}

const DrawnFrame* drawn_at(const std::vector<DrawnFrame>& drawn, int frame) {
  const auto at =
      std::find_if(drawn.begin(), drawn.end(), [frame](const DrawnFrame& one) { return one.frame == frame; });
  return at != drawn.end() ? &*at : nullptr;
}

std::vector<DrawnFrame> without_drawn(std::vector<DrawnFrame> drawn, int frame) {
  std::erase_if(drawn, [frame](const DrawnFrame& one) { return one.frame == frame; });
  return drawn;
}

std::vector<DrawnFrame> with_drawn(std::vector<DrawnFrame> drawn, DrawnFrame frame) {
  drawn = without_drawn(std::move(drawn), frame.frame);
  const auto behind = std::find_if(drawn.begin(), drawn.end(),
                                   [&](const DrawnFrame& one) { return one.frame > frame.frame; });
  drawn.insert(behind, std::move(frame));
  return drawn;
}

std::string CarriedTruth::told() const {
  std::string text =
      fmt::format("{}: {} drawn, {} carried", counted(drawn + carried, "mask"), drawn, carried);
  if (!unreadable.empty())
    text += fmt::format("; frames {} cannot be read, and have none", frames_text(unreadable));
  if (scores.empty()) return text;
  std::vector<CarryingScore> sorted = scores;
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const CarryingScore& a, const CarryingScore& b) { return a.iou < b.iou; });
  return text + fmt::format(
                    ". Carried from one drawn frame to the next they agree with what is drawn there "
                    "to an IoU of {:.2f} (median of {}; least {:.2f}, from frame {} to {})",
                    sorted[sorted.size() / 2].iou, sorted.size(), sorted.front().iou, sorted.front().from,
                    sorted.front().to);
}

CarriedTruth carry_drawn(const FrameSource& source, const std::vector<DrawnFrame>& drawn,
                         const std::function<void(int, const cv::Mat&)>& take, const ExportControl& control) {
  return Carrier(source, take, control).carry(drawn);
}

bool may_take_masks(const fs::path& folder) {
  std::error_code error;
  if (!fs::exists(folder / kList, error)) return !fs::exists(folder / kFolder, error);
  std::ifstream list(folder / kList);
  std::string line;
  return std::getline(list, line) && line.starts_with(kSign);
}

std::optional<CarriedTruth> write_drawn_truth(const FrameSource& source, const std::vector<DrawnFrame>& drawn,
                                              const fs::path& folder, const ExportControl& control) {
  if (!may_take_masks(folder))
    throw InputError(fmt::format("{}: has masks that were not drawn here, and keeps them", folder.string()));
  const fs::path part = folder / kNewFolder;
  std::error_code ignored;
  try {
    return in_folder(folder, [&]() -> std::optional<CarriedTruth> {
      fs::remove_all(part);
      fs::create_directories(part);
      std::map<int, std::string> names;
      CarriedTruth carried = carry_drawn(
          source, drawn,
          [&](int index, const cv::Mat& mask) {
            const std::string& name = names[index] = fmt::format("{:06}.png", index);
            if (!save_image(part / name, mask))
              throw InputError(fmt::format("{}: cannot be written", (part / name).string()));
          },
          control);
      if (control.stop != nullptr && *control.stop) {
        fs::remove_all(part);
        return std::nullopt;
      }
      fs::remove_all(folder / kFolder);
      fs::rename(part, folder / kFolder);
      write_text_file(folder / kList, list_text(source, drawn, names));
      return carried;
    });
  } catch (const InputError&) {
    fs::remove_all(part, ignored);
    throw;
  }
}

}  // namespace stillpoint
