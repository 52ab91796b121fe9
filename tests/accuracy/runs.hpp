#pragma once

#include <string>

namespace stillpoint {

/// A sequence to run on: its kind and seed.
struct SequenceChoice {
  std::string kind;
  unsigned seed = 1;
};

/// `KIND_SEED`, as tests are named.
[[nodiscard]] std::string name_of(const SequenceChoice& sequence);

/// What a run is held to.
struct RunFigures {
  double rpe_m = 0.0;     ///< m, RMSE of the relative pose error over 1 s, final trajectory
  int pairs = 0;          ///< pairs of poses it was taken over
  double coverage = 0.0;  ///< share of the frames with an estimated pose
  double iou = -1.0;  ///< of the masks, 0 to 1, over all frames; -1 where nothing moves and nothing is masked
  double masked = 0.0;     ///< mean share of the pixels in the mask, 0 to 1
  int masked_frames = 0;   ///< frames with a mask that is not empty
  std::string first_hash;  ///< run_hash of the first kHashedFrames records
};

inline constexpr int kFrames = 60;        ///< of each sequence: 2 s, so 30 pairs of poses that are 1 s apart
inline constexpr int kHashedFrames = 40;  ///< a run's hash is pinned over so many

/// The method's run over the sequence, made when it is first asked for and kept.
const RunFigures& figures_of(const SequenceChoice& sequence, const std::string& method);

}  // namespace stillpoint
