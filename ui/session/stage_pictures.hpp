#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "ui/session/scene_point.hpp"
#include "ui/session/stages.hpp"

namespace stillpoint {

// What a stage takes, what it makes and what changed, as images and marks: computed here, coloured and drawn
// by the panel.

/// How the values of a picture are to be read.
enum class PictureLook {
  kPhoto,       ///< grey or colour image, or grey levels as CV_32FC1
  kLevels,      ///< CV_8UC1, 0 to `range` grey levels
  kMask,        ///< CV_8UC1, non-zero = set, over `ground`
  kMaskChange,  ///< CV_8UC1 of MaskChange, over `ground`
  kSigned,      ///< CV_32FC1, -range to range, NaN = nothing
  kLength,      ///< CV_32FC1, 0 to `range`, NaN or 0 = nothing
};

/// The values of a picture of changes between two masks.
enum MaskChange : std::uint8_t { kClear = 0, kStays = 1, kGained = 2, kLost = 3 };

enum class DotKind { kInlier, kOutlier, kRemoved, kKept, kUnmatched, kGained, kLost };

/// A feature, or a track where `from` is set.
struct PictureDot {
  cv::Point2f at;
  std::optional<cv::Point2f> from;
  DotKind kind = DotKind::kInlier;
};

struct StagePicture {
  std::string heading;  ///< "Frame 12"
  PictureLook look = PictureLook::kPhoto;
  cv::Mat image;  ///< empty: there is none, and the heading says so
  cv::Mat ground{};
  double range = 0.0;
  std::string unit{};
  FrameSpace space = FrameSpace::kTarget;
  std::vector<PictureDot> dots{};
  bool elsewhere = false;  ///< of a frame outside the pair: points cannot be carried into it
};

/// What changed, and against what.
struct StageChange {
  std::string against;  ///< "Stage before": what the picture is held against
  StagePicture picture;
  std::string text;  ///< "1,240 px gained, 310 px lost"
};

enum class ChangeAgainst { kStageBefore, kRoundBefore, kFrameBefore };

struct StagePictures {
  std::vector<StagePicture> inputs;
  StagePicture output;
};

/// @param backward the other direction of stages that have two
[[nodiscard]] StagePictures stage_pictures(const FrameView& view, const Camera& camera, const Config& config,
                                           const StageInfo& stage, bool backward);

/// The same of stages that judge motion by followed points (of_colour).
[[nodiscard]] StagePictures colour_pictures(const FrameView& view, const Config& config,
                                            const StageInfo& stage);

/// Nothing where there is nothing to hold the stage against.
[[nodiscard]] std::optional<StageChange> stage_change(const FrameView& view, const Camera& camera,
                                                      const Config& config, const StageInfo& stage,
                                                      bool backward, ChangeAgainst against);

/// MaskChange of every pixel. @param before,after CV_8UC1 of one size; `before` empty = nothing was set
[[nodiscard]] cv::Mat mask_change(const cv::Mat& before, const cv::Mat& after);

}  // namespace stillpoint
