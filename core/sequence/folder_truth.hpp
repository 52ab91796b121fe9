#pragma once

#include <string>
#include <vector>

#include "core/geometry/pose_convention.hpp"
#include "core/geometry/trajectory.hpp"
#include "core/sequence/file_store.hpp"
#include "core/sequence/stamps.hpp"

namespace stillpoint {

/// A folder's ground truth, or why what is there is of no use.
struct FolderTruth {
  std::string path;     ///< of the file; empty where there is none
  Trajectory poses;     ///< s, camera to world; empty where there is none or it is of no use
  std::string why_not;  ///< one sentence
  std::vector<std::string> warnings;
};

/// Reads `groundtruth.txt` (`groundtruth.csv`, `ground_truth.txt`, `gt.txt`, or ICL-NUIM's `*.gt.freiburg`)
/// in any format of read_trajectory_file, in the unit under which most of its stamps meet frames. Truth that
/// cannot be read or meets no frame costs the truth, not the sequence.
/// @param frame_stamps s, increasing; @param unit what they were written in; @param frame_rate Hz, of frame
/// numbers
[[nodiscard]] FolderTruth read_folder_truth(const FileStore& folder, const std::vector<double>& frame_stamps,
                                            StampUnit unit, double frame_rate, PoseConvention convention);

/// Truth as it was read, in whatever unit and convention, made fit for frames: what read_folder_truth does
/// once the file is read. @param path names it in messages
[[nodiscard]] FolderTruth settle_truth(const std::string& path, Trajectory poses,
                                       const std::vector<double>& frame_stamps, StampUnit unit,
                                       double frame_rate, PoseConvention convention);

}  // namespace stillpoint
