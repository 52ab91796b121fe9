#pragma once

#include <cstdint>
#include <string>

namespace stillpoint {

/// What a figure is measured in; times in ms, lengths in m, shares 0 to 1.
enum class FigureUnit : std::uint8_t { plain, metres, degrees, pixels, milliseconds, share, truth };

/// Which values of a figure are the bad ones.
enum class WorseWhen : std::uint8_t { neither, high, low };

/// A figure known of each frame.
struct FigureInfo {
  std::string name;  ///< in conditions: "rpe"
  FigureUnit unit = FigureUnit::plain;
  std::string help;  ///< one line
  int digits = 4;    ///< after the point, in CSV; 0 for counts
  WorseWhen worse = WorseWhen::neither;
  std::string title{};     ///< for people: "Step error"; empty: the name is shown
  std::string column{};    ///< its head in CSV, which conditions take too: "rpe_frame_m"; empty: the name
  std::string old_name{};  ///< what it was called before; conditions take it for one version more
};

}  // namespace stillpoint
