#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "core/motion/motion_method.hpp"
#include "core/parameter.hpp"

namespace stillpoint {

struct Config;

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

/// The masks a config names, opened when they are first asked for: a stage is made for every frame that is
/// shown, and most read none. A value, whose copies share what was opened; reading is const and safe from
/// several threads at once.
class OutsideMasks {
 public:
  explicit OutsideMasks(const Config& config);

  /// Whether the config names some.
  [[nodiscard]] bool any() const { return opened_ != nullptr; }
  /// Why a source cannot be used, one sentence, told of each frame; empty when all is well.
  [[nodiscard]] std::string problem() const;
  /// What each source's files are named by, a few words with its name.
  [[nodiscard]] std::vector<std::string> namings() const;
  /// How the images were understood, where that could be doubted.
  [[nodiscard]] std::vector<std::string> warnings() const;

  /// The frame's mask of all sources that have one. Never throws.
  [[nodiscard]] std::shared_ptr<const OutsideMask> read(const Frame& frame) const;

 private:
  struct Opened;
  std::shared_ptr<const Opened> opened_;  ///< null where none are named
  bool intersect_ = false;
  int grow_px_ = 0;
};

/// Makes a method's own judgement and the outside mask one, by `with_method`. A mask that is missing changes
/// nothing.
void combine_with_outside(const MasksConfig& config, const MotionInput& input, MotionResult& result);

/// Adds the stage that shows the outside mask, and the mask the run used.
void describe_outside(const Frame& frame, const MotionResult& result, StageLog& log);

}  // namespace stillpoint
