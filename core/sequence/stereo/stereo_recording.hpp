#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/geometry/camera.hpp"
#include "core/geometry/se3.hpp"
#include "core/sequence/file_store.hpp"
#include "core/sequence/folder_lists.hpp"
#include "core/sequence/source.hpp"
#include "core/sequence/stereo/stereo_rectification.hpp"

namespace stillpoint {

// Stereo recordings as they are published. Each reader knows one layout by what lies in the folder.

/// What a folder (or an archive of one) says of a stereo recording.
struct StereoRecording {
  FolderLists
      lists;      ///< colours: the left images; depths: the right ones, which belong to them by their stamps
  Camera camera;  ///< of the left images as they are read, with the baseline
  std::shared_ptr<const StereoRectification> rectification;  ///< null: the images are rectified
  std::string truth;                         ///< name of the file of ground truth; empty: as for any folder
  bool is_pose_a_row = false;                ///< it has no stamps: row i is that of `row_stamps[i]`
  std::vector<double> row_stamps;            ///< s
  bool stamped_in_ns = false;                ///< the layout says so, and there is nothing to wonder at
  Pose body_from_camera = Pose::Identity();  ///< of the body whose poses it holds, from the camera
};

/// KITTI odometry: `image_0/` and `image_1/` (grey) or `image_2/` and `image_3/` (colour), rectified;
/// `calib.txt` with P0 to P3; `times.txt`; poses (of camera 0) in `poses.txt`, or in `../../poses/NAME.txt`
/// as downloaded. Row i of times and poses is image i by its number, or the i-th image where there are as
/// many.
/// @return nothing where the folder is none
/// @throws InputError for one that cannot be used
[[nodiscard]] std::optional<StereoRecording> read_kitti(const FileStore& folder, const OpenOptions& options);

/// EuRoC and the ASL format: `mav0/cam0` and `mav0/cam1` (or without `mav0`), each with `data/`, `data.csv`
/// and `sensor.yaml` (intrinsics, radial-tangential distortion, T_BS); ground truth of the body in
/// `state_groundtruth_estimate0/data.csv`.
[[nodiscard]] std::optional<StereoRecording> read_euroc(const FileStore& folder, const OpenOptions& options);

/// TartanAir: `image_left/` and `image_right/`, rectified, numbered; poses of the left camera, of axes
/// forward, right and down, a row an image, in `pose_left.txt`; the data set's camera, where no `camera.toml`
/// says another.
[[nodiscard]] std::optional<StereoRecording> read_tartanair(const FileStore& folder,
                                                            const OpenOptions& options);

/// `left/` and `right/` (or `Left/`, `Right/`; `image_left/`, `image_right/`), rectified, with `camera.toml`
/// or `camera.yaml` that has the baseline; images are stamped by their names' numbers or, in order, by
/// `times.txt`; masks and ground truth as in the TUM layout.
[[nodiscard]] std::optional<StereoRecording> read_left_right(const FileStore& folder,
                                                             const OpenOptions& options);

/// Whichever of these the folder is.
[[nodiscard]] std::optional<StereoRecording> read_stereo_recording(const FileStore& folder,
                                                                   const OpenOptions& options);

/// The numbers of a file that has one a line.
/// @throws InputError naming the line that has none
[[nodiscard]] std::vector<double> read_times(const FileStore& folder, const std::string& name);

/// Stamps both lists, whose entries hold the numbers of their images, by the rows of a list of times.
/// @returns what was mended, one sentence; empty mostly
/// @throws InputError where there is a number without a row
void stamp_by_times(const std::string& path, const std::vector<double>& times, FolderLists& lists);

}  // namespace stillpoint
