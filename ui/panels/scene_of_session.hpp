#pragma once

#include <optional>
#include <vector>

#include "ui/scene/scene_data.hpp"

namespace stillpoint {

struct SessionView;

/// What of a session the trajectory view shows.
struct SceneLayers {
  bool points = true, keyframes = true, errors = true;
  bool operator==(const SceneLayers&) const = default;
};

/// The frame a position of a path belongs to.
struct PathFrame {
  int index = 0;
  double seconds = 0.0;           ///< since the run's first frame
  std::optional<double> error_m;  ///< to the pose's truth, after alignment
};

/// The scene, and for each of its paths the frames of its positions (none for the ground truth).
struct SessionScene {
  SceneData data;
  std::vector<std::vector<PathFrame>> frames_of_path;
  std::vector<std::size_t>
      ghost_paths;  ///< of each ghost, index into the paths; their colours are the panel's
};

/// What to bring into sight at first: the paths, and a part of the way out to where most map points lie.
/// Paths alone would hide the room the camera moves in, and points alone the way it went.
[[nodiscard]] SceneBounds sight_of(const SceneData& data);

/// Run, baseline, ground truth, keyframes, current camera and map in one world: the truth's, where there is
/// one, z up; else the first camera's, whose y axis points down.
[[nodiscard]] SessionScene scene_of_session(const SessionView& session, const SceneLayers& layers);

}  // namespace stillpoint
