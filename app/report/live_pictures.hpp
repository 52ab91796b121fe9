#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <set>
#include <string>
#include <vector>

#include "app/report/report_pictures.hpp"
#include "app/report/report_run.hpp"

namespace stillpoint {

/// What an interactive report shows of its frames.
struct LivePictureOptions {
  int width = 480;                  ///< px, of pictures of wider frames
  double most_mb = 20.0;            ///< MB, of all pictures of the page together
  std::vector<std::string> layers;  ///< ids of stages' layers that are shown too
};

/// A sequence's frames as an interactive report holds them.
struct LivePictures {
  cv::Size size;                    ///< px
  int every = 1;                    ///< every so many frames have a picture, the worst ones besides
  int frames = 0;                   ///< of the sequence's runs
  std::size_t bytes = 0;            ///< of all pictures, as text
  std::string why_none;             ///< one sentence; empty where there are pictures
  std::vector<std::string> layers;  ///< ids, in the order of a picture's
  /// In order: {frame, colour, truth?, runs: [{mask?, features?, layers: [… or null]}]}. Pictures are base64
  /// of PNG or JPEG; truth and mask have colour where the mask is set and nothing elsewhere; features are two
  /// little-endian 16-bit numbers each: x with the FeatureFate in its upper two bits, and y, px of the frame.
  nlohmann::ordered_json pictures = nlohmann::ordered_json::array();
};

/// Pictures of as many frames as there is room for: of all, or of every second, fourth, eighth, …, and of
/// each run's worst frames.
/// @param most_bytes as text @param worst how many frames of each run @param found takes the layers that
/// frames had
[[nodiscard]] LivePictures live_pictures(const ReportGroup& group, const LivePictureOptions& options,
                                         std::size_t most_bytes, int worst, std::set<std::string>& found,
                                         const ReportProgress& progress);

/// Which frames have pictures, a sentence or two: as page and command line tell it.
[[nodiscard]] std::string pictures_text(const LivePictures& pictures);

}  // namespace stillpoint
