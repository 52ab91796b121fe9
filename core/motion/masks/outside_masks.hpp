#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "core/motion/motion_method.hpp"
#include "core/parameter.hpp"

namespace stillpoint {

struct Config;
class MaskFiles;

/// Masks that somebody else made: method `masks` removes by them alone, any other method with them.
struct MasksConfig {
  static constexpr const char* kSection = "masks";
  MasksConfig() { set_defaults(*this); }
  void list(ParameterTable& table);
  bool operator==(const MasksConfig&) const = default;

  std::string sources;  ///< folders and lists, parted by commas; empty: there are none
  std::string labels;   ///< parted by commas, as MaskReading has them
  bool inverted;
  int first_number;
  std::string combine;      ///< "union" or "intersection" of the sources
  std::string with_method;  ///< "union" or "intersection" with a method's own mask
  int grow_px;
};

/// The sources of a list, blanks about them left out.
[[nodiscard]] std::vector<std::string> split_masks(const std::string& list);

/// The masks a config names. A value; reading is const and safe from several threads at once.
class OutsideMasks {
 public:
  /// What cannot be opened is kept as problem(), and told again of each frame.
  explicit OutsideMasks(const Config& config);

  [[nodiscard]] bool any() const { return !sources_.empty() || !problem_.empty(); }
  /// Why a source cannot be used, one sentence; empty when all is well.
  [[nodiscard]] const std::string& problem() const { return problem_; }
  /// How the images were understood, where that could be doubted.
  [[nodiscard]] std::vector<std::string> warnings() const;

  /// The frame's mask of all sources that have one. Never throws.
  [[nodiscard]] std::shared_ptr<const OutsideMask> read(const Frame& frame) const;

 private:
  std::vector<std::shared_ptr<const MaskFiles>> sources_;
  std::string problem_;
  bool intersect_ = false;
  int grow_px_ = 0;
};

/// Makes a method's own judgement and the outside mask one, by `with_method`. A mask that is missing changes
/// nothing.
void combine_with_outside(const MasksConfig& config, const MotionInput& input, MotionResult& result);

/// Adds the stage that shows the outside mask, and the mask the run used.
void describe_outside(const Frame& frame, const MotionResult& result, StageLog& log);

}  // namespace stillpoint
