#pragma once

#include <functional>
#include <map>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

namespace stillpoint {

// A frame's way through its method, stage by stage, as data: what each stage took, made and measured. A
// method describes itself in these terms, and panels, inspector, report and files read them without knowing
// the method. Pixels are OpenCV's: the middle of pixel (i, j) is (i, j).

/// The spaces in which images of a frame, and of the one it is compared with, have their pixels.
enum class FrameSpace {
  kTarget,               ///< frame t as the camera saw it
  kReference,            ///< the frame it is compared with (StageLog::reference)
  kCompensatedForward,   ///< the reference warped into the target's camera by StageLog::forward
  kCompensatedBackward,  ///< the target warped into the reference's camera by StageLog::backward
  kSmall,                ///< frame t downsampled by StageLog::small_factor
};

/// How the values of an image are to be read.
enum class LayerKind {
  kPhoto,       ///< grey or colour image, or grey levels as CV_32FC1
  kLevels,      ///< CV_8UC1, 0 to `range`
  kClasses,     ///< CV_8UC1: numbers of classes, from 1, `range` of them; 0 = of none
  kMask,        ///< CV_8UC1, non-zero = set, over `ground`
  kMaskChange,  ///< CV_8UC1 of MaskChange, over `ground`
  kSigned,      ///< CV_32FC1, -range to range, NaN = nothing
  kLength,      ///< CV_32FC1, 0 to `range`, NaN or 0 = nothing
};

/// The values of an image of changes between two masks.
enum MaskChange : std::uint8_t { kClear = 0, kStays = 1, kGained = 2, kLost = 3 };

enum class MarkKind { kInlier, kOutlier, kRemoved, kKept, kUnmatched, kGained, kLost };

/// A point in an image, or a track where `from` is set.
struct Mark {
  cv::Point2f at;
  std::optional<cv::Point2f> from;
  MarkKind kind = MarkKind::kInlier;
};

/// One image of a stage, and what is marked in it.
struct Layer {
  std::string name;  ///< "Difference"
  LayerKind kind = LayerKind::kPhoto;
  cv::Mat image;     ///< empty: there is none
  cv::Mat ground{};  ///< what a mask lies over
  double range = 0.0;
  std::string unit{};
  FrameSpace space = FrameSpace::kTarget;
  std::vector<Mark> marks{};
  std::string id{};  ///< "difference": by which panels and tests find it; empty where none need to
  std::optional<double> limit{};            ///< a value above it speaks for motion
  cv::Mat valid{};                          ///< CV_8UC1: 0 where the image has no data; empty = all of it has
  bool elsewhere = false;                   ///< of a frame outside the pair: points cannot be mapped into it
  std::map<MarkKind, std::string> words{};  ///< what marks stand for here, where not for what they are called

  /// What a kind of mark stands for: "static" where the layer says so, else "inlier".
  [[nodiscard]] std::string word_of(MarkKind mark) const;
};

/// A number a stage ends with.
struct StageFigure {
  std::string name;
  double value = 0.0;
  std::string unit;                                  ///< "px", "%", "" for counts
  int digits = 0;                                    ///< after the point
  std::optional<double> round_before, frame_before;  ///< the same figure there
};

/// What a stage takes and makes, in one direction where it has two.
struct StageSide {
  std::string name;  ///< "Forward"; empty where there is but one
  std::vector<Layer> inputs;
  Layer output;
};

struct Stage {
  std::string id;      ///< "threshold": the same of every frame and round
  int round = -1;      ///< from 0; below 0 where the stage has no rounds
  int reference = -1;  ///< from 0: which of several earlier frames; below 0 where it has none
  std::string group;   ///< "Round 2": what it stands under in a list
  std::string name;    ///< "Threshold"
  std::string what;    ///< one sentence: what it does, with its source's equation
  double ms = 0.0;     ///< of wall time; 0 where times are not kept
  bool timed = true;   ///< false: it has no time of its own
  std::vector<StageFigure> figures{};
  std::string note{};  ///< why it has nothing to show, or what is odd about it; empty when all is well
  std::vector<StageSide> sides{};
  bool overview = false;  ///< its output belongs in the picture that shows the method at a glance
  int frames_back = 0;    ///< how far back its reference lies: stages of unlike gaps are not compared

  /// Whether two stages are the same one of different frames.
  [[nodiscard]] bool same_place(const Stage& other) const {
    return id == other.id && round == other.round && reference == other.reference;
  }
  Stage& figure(std::string figure_name, double value, std::string unit = "", int digits = 0) {
    figures.push_back({std::move(figure_name), value, std::move(unit), digits, {}, {}});
    return *this;
  }
  void add_side(std::vector<Layer> inputs, Layer output, std::string side_name = {}) {
    sides.push_back({std::move(side_name), std::move(inputs), std::move(output)});
  }
};

/// All stages of one frame by one method, in order.
struct StageLog {
  std::string method;         ///< whose stages these are
  std::vector<Stage> stages;  ///< empty: `note` says why
  std::string note;           ///< why there are none, or why there is no mask; empty when all is well

  /// What a method compared the frame with, where it is one earlier frame; below 0 where it is none.
  int reference = -1;
  cv::Mat reference_gray;                        ///< CV_8UC1: that frame, as the method saw it
  std::optional<cv::Matx33d> forward, backward;  ///< target from reference, and the other way
  int small_factor = 1;                          ///< full-size pixels a side of one of FrameSpace::kSmall

  /// Why a pixel of the target is classified as it is, in the method's words; null where it has none.
  /// @param removed whether the feature there was removed
  std::function<std::vector<std::string>(const cv::Point2f& pixel, bool removed)> explain;

  /// Adds a stage and gives it back.
  Stage& add(std::string id, std::string group, std::string name, std::string what);

  /// The layer with an id: of the last round, or of round `round` (from 0). Null where there is none.
  [[nodiscard]] const Layer* layer(const std::string& id, int round = -1) const;
  /// The stage that makes it.
  [[nodiscard]] const Stage* stage_of_layer(const std::string& id, int round = -1) const;
  /// How many rounds the stages with rounds went through.
  [[nodiscard]] int rounds() const;
};

/// Makes layers.
[[nodiscard]] Layer photo_layer(std::string name, const cv::Mat& image,
                                FrameSpace space = FrameSpace::kTarget);
[[nodiscard]] Layer mask_layer(std::string name, const cv::Mat& mask, const Layer& ground,
                               std::string id = {});
[[nodiscard]] Layer signed_layer(std::string name, const cv::Mat& values, double range, std::string unit,
                                 FrameSpace space, std::optional<double> limit = std::nullopt);
/// Its range ends at the largest value, or at 1.
[[nodiscard]] Layer length_layer(std::string name, const cv::Mat& values, std::string unit, FrameSpace space);
/// The same layer with other marks, under another name.
[[nodiscard]] Layer marked(std::string name, Layer ground, std::vector<Mark> marks);

/// Share of a mask's pixels that are set, percent; 0 of an empty one.
[[nodiscard]] double percent_set(const cv::Mat& mask);
/// Share of the values above a limit, and of those that are known (not NaN), percent.
[[nodiscard]] double percent_above(const cv::Mat& values, double limit);
[[nodiscard]] double percent_known(const cv::Mat& values);

/// "12.3 px"
[[nodiscard]] std::string figure_text(const StageFigure& figure);
/// "+3.1 px" against an earlier value; "±0" where nothing changed.
[[nodiscard]] std::string change_text(const StageFigure& figure, double before);

/// The index of the stage that is the same as `wanted`, or of the nearest of its kind, or 0.
[[nodiscard]] std::size_t find_stage(const std::vector<Stage>& stages, const Stage& wanted);

}  // namespace stillpoint
