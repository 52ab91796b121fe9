#include "core/motion/masks/outside_masks.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <mutex>
#include <opencv2/imgproc.hpp>

#include "core/config.hpp"
#include "core/error.hpp"
#include "core/sequence/mask_files.hpp"

namespace stillpoint {
namespace {

void grow(cv::Mat& mask, int radius) {
  if (radius == 0) return;
  cv::dilate(mask, mask,
             cv::getStructuringElement(cv::MORPH_ELLIPSE, cv::Size(2 * radius + 1, 2 * radius + 1)));
}

double share_of(const cv::Mat& mask) {
  return mask.empty() ? 0.0 : static_cast<double>(cv::countNonZero(mask)) / static_cast<double>(mask.total());
}

/// Log-odds of motion no larger than -20 where the outside mask says static: weight 1.
void calm_outside(const cv::Mat& outside, cv::Mat& log_odds) {
  constexpr double kStatic = -20.0;  // log-odds: a weight of 1 to the last bit
  if (log_odds.empty()) return;
  cv::Mat small;
  cv::resize(outside, small, log_odds.size(), 0, 0, cv::INTER_NEAREST);
  log_odds = log_odds.clone();
  log_odds.setTo(kStatic, small == 0);
}

}  // namespace

std::vector<std::string> split_masks(const std::string& list) {
  std::vector<std::string> parts;
  std::size_t begin = 0;
  while (begin <= list.size()) {
    const std::size_t comma = std::min(list.find(',', begin), list.size());
    const std::size_t first = list.find_first_not_of(' ', begin);
    if (first < comma) {
      const std::size_t last = list.find_last_not_of(' ', comma - 1);
      parts.push_back(list.substr(first, last - first + 1));
    }
    begin = comma + 1;
  }
  return parts;
}

void MasksConfig::list(ParameterTable& table) {
  table.text("sources", sources,
             "folders or lists of masks made elsewhere, parted by commas; every method removes by them too");
  table.text(
      "labels", labels,
      "what is dynamic in label images: values such as 15, or colours such as #c00080, parted by commas");
  table.flag("inverted", inverted, false, "white in these masks is what stands still");
  table.number("first_number", first_number, -1, -1, 1000000, "",
               "number of the first frame's mask where names are numbers; -1: 1 where there is no 0, else 0");
  table.choice("combine", combine, "union", {"union", "intersection"},
               "of several sources: what any of them says, or what all say");
  table.choice("with_method", with_method, "union", {"union", "intersection"},
               "with a method's own mask: what either says, or what both say");
  table.number("grow_px", grow_px, 0, 0, 100, "px", "added to what is dynamic on all sides");
}

/// The sources, from the first time that somebody asks for them.
struct OutsideMasks::Opened {
  explicit Opened(const MasksConfig& named) : config(named) {}

  [[nodiscard]] const std::vector<MaskFiles>& files() const {
    std::call_once(once, [this] {
      try {
        for (const std::string& where : split_masks(config.sources))
          sources.emplace_back(where,
                               MaskReading{split_masks(config.labels), config.inverted, config.first_number});
      } catch (const InputError& error) {
        problem = error.what();
        sources.clear();
      }
    });
    return sources;
  }

  const MasksConfig config;
  mutable std::once_flag once;
  mutable std::vector<MaskFiles> sources;
  mutable std::string problem;
};

OutsideMasks::OutsideMasks(const Config& config) {
  const auto& masks = config.of<MasksConfig>();
  intersect_ = masks.combine == "intersection";
  grow_px_ = masks.grow_px;
  if (!split_masks(masks.sources).empty()) opened_ = std::make_shared<const Opened>(masks);
}

std::string OutsideMasks::problem() const {
  if (!any()) return {};
  (void)opened_->files();
  return opened_->problem;
}

std::vector<std::string> OutsideMasks::namings() const {
  std::vector<std::string> all;
  if (!any()) return all;
  for (const MaskFiles& source : opened_->files())
    all.push_back(fmt::format("{}: {}", source.where(), source.naming()));
  return all;
}

std::vector<std::string> OutsideMasks::warnings() const {
  std::vector<std::string> all;
  if (!any()) return all;
  for (const MaskFiles& source : opened_->files())
    all.insert(all.end(), source.warnings().begin(), source.warnings().end());
  return all;
}

std::shared_ptr<const OutsideMask> OutsideMasks::read(const Frame& frame) const {
  auto outside = std::make_shared<OutsideMask>();
  outside->problem = problem();
  if (frame.gray.empty() || !any()) return outside;
  for (const MaskFiles& files : opened_->files()) {
    FoundMask found = files.read(frame);
    if (!found.problem.empty()) outside->problem += (outside->problem.empty() ? "" : "; ") + found.problem;
    if (!found.mask.empty()) {
      grow(found.mask, grow_px_);
      if (outside->mask.empty())
        outside->mask = found.mask;
      else
        outside->mask =
            intersect_ ? cv::Mat(outside->mask & found.mask) : cv::Mat(outside->mask | found.mask);
    }
    outside->sources.push_back({std::filesystem::path(files.where()).filename().string(), found.mask});
  }
  return outside;
}

void combine_with_outside(const MasksConfig& config, const MotionInput& input, MotionResult& result) {
  result.outside = input.outside;
  if (!input.outside) return;
  if (!input.outside->problem.empty()) result.mask_problem = input.outside->problem;
  const cv::Mat& outside = input.outside->mask;
  if (outside.empty()) return;
  const cv::Mat own = result.mask;
  if (config.with_method == "union") {
    result.mask = own.empty() ? outside : cv::Mat(own | outside);
  } else {
    if (!own.empty()) result.mask = own & outside;
    calm_outside(outside, result.log_odds);
    const cv::Rect frame(cv::Point(), outside.size());
    for (std::size_t i = 0; i < result.weight_of_feature.size() && i < input.features.size(); ++i) {
      const cv::Point at(input.features[i].pixel);
      if (frame.contains(at) && outside.at<std::uint8_t>(at) == 0) result.weight_of_feature[i] = 1.0F;
    }
  }
  result.mask_share = share_of(result.mask);
}

void describe_outside(const Frame& frame, const MotionResult& result, StageLog& log) {
  if (!result.outside) return;
  const Layer ground = photo_layer("Frame", frame.gray);
  Stage& stage = log.add("outside_mask", "Outside masks", "Outside mask",
                         "Masks made elsewhere, as they belong to this frame.");
  stage.timed = false;
  stage.note = result.outside->problem;
  stage.figure("Outside mask", 100.0 * share_of(result.outside->mask), "%", 2);
  for (const OutsideMask::Source& source : result.outside->sources)
    if (!source.mask.empty())
      stage.add_side({ground}, mask_layer(source.name, source.mask, ground), source.name);
  Stage& used = log.add("combined_mask", "Outside masks", "Mask",
                        "What the run removes by: the method's own mask and the outside one together.");
  used.timed = false;
  used.figure("Mask", 100.0 * result.mask_share, "%", 2);
  used.overview = true;
  used.add_side({mask_layer("Outside mask", result.outside->mask, ground, "outside_mask")},
                mask_layer("Mask", result.mask, ground, "mask"));
}

}  // namespace stillpoint
