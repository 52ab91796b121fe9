#pragma once

#include <optional>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include "core/check/findings.hpp"
#include "core/check/time_calibration.hpp"
#include "core/sequence/source.hpp"

namespace stillpoint {

/// What a sequence was questioned by, and what was found.
struct SequenceCheck {
  std::vector<Finding> findings;
  TimeCalibration times;  ///< as its own frames tell them
};

/// All that a sequence can be questioned by, in some seconds: its lists and images, the odometry over its
/// first frames beside its ground truth, other cameras, and when its rows were measured.
/// @param stop what was found by then is returned
[[nodiscard]] SequenceCheck check_sequence(const FrameSource& source, const std::stop_token& stop = {});

/// A switch that mends a finding.
struct Remedy {
  std::string name;   ///< "depth-scale"
  std::string value;  ///< "1000"; empty for a switch without
  /// As it is typed: "--depth-scale 1000".
  [[nodiscard]] std::string text() const;
  bool operator==(const Remedy&) const = default;
};

/// The switch that a finding names between backticks, where it mends the finding for certain: a camera, a
/// depth scale, what the truth's poses mean, the times as measured. Others are guesses (a clock that may be
/// off, masks that may be inverted), and a person's to decide.
[[nodiscard]] std::optional<Remedy> remedy_of(const Finding& finding);

/// Of several remedies the one to begin with: what is wrong with depth or camera lets the truth look wrong.
/// @param given names of switches that were given already, and stand
[[nodiscard]] std::optional<std::pair<Remedy, Finding>> first_remedy(const std::vector<Finding>& findings,
                                                                     const std::vector<std::string>& given);

}  // namespace stillpoint
