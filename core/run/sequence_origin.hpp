#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "core/geometry/camera.hpp"
#include "core/sequence/source.hpp"

namespace stillpoint {

/// Where a run's frames came from: enough to open them again, and to notice when they are no longer the same.
struct SequenceOrigin {
  std::string name;                      ///< as titles show it
  std::string where;                     ///< an absolute folder, or generated:KIND
  std::string where_from_run;            ///< a folder, from the run's; empty where that is not known
  int frames = 0;                        ///< in the sequence as it was opened
  int frames_asked = 0;                  ///< OpenOptions::frames
  unsigned seed = 1;                     ///< of a generated sequence
  Camera camera;                         ///< as used
  double frame_rate = kFrameNumberRate;  ///< these seven as in OpenOptions
  double depth_offset_s = 0.0;
  PoseConvention truth = PoseConvention::as_written;
  bool inverted_masks = false;
  std::optional<double> depth_scale;
  std::string topics;
  StereoOptions stereo;
  bool has_depth = true;
  std::string fingerprint;  ///< sequence_fingerprint

  [[nodiscard]] bool is_generated() const { return where.starts_with("generated:"); }
};

/// @param where, options as open_sequence was given them
[[nodiscard]] SequenceOrigin origin_of(const FrameSource& source, const std::string& where,
                                       const OpenOptions& options);

/// As `summary.json` and `records.bin` hold it.
/// @param run_folder beside the absolute folder the one relative to it is written, so that run and sequence
/// can be moved together; empty = not
[[nodiscard]] nlohmann::ordered_json to_json(const SequenceOrigin& origin,
                                             const std::filesystem::path& run_folder);

/// @throws nlohmann::json::exception for what is missing or of another type
[[nodiscard]] SequenceOrigin origin_from_json(const nlohmann::json& json);

}  // namespace stillpoint
