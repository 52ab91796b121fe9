#pragma once

#include <string>

namespace stillpoint {

/// StereoSGBM's disparities come in multiples of it, each in as many parts.
inline constexpr int kDisparityStep = 16;

/// How a stereo pair is matched.
struct StereoOptions {
  bool half = false;             ///< at half the images' size: four to eight times as fast, and less exact
  int disparities = 0;           ///< px, how far apart left and right are sought; 0 = by the images' width
  bool left_right_check = true;  ///< a match holds only where the right image's best match leads back
  bool operator==(const StereoOptions&) const = default;
};

/// "size=half,disparities=96,check=off", what differs from the default alone; empty where nothing does.
[[nodiscard]] std::string to_text(const StereoOptions& options);

/// Reads the same: size=full|half, disparities=N (16 to 512 px, a multiple of 16), check=on|off.
/// @param option names the text in messages: "--stereo"
/// @throws InputError for another key or value, naming those there are
[[nodiscard]] StereoOptions stereo_options_from(const std::string& text, const std::string& option);

}  // namespace stillpoint
