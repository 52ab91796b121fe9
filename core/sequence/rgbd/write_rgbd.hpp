#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/sequence/source.hpp"

namespace stillpoint {

struct RgbdLayout;

/// Where a layout has a frame's images, in the sequence's folder, and its stamp as the layout has it.
struct RgbdNames {
  std::string colour, depth;  ///< the ending tells the format: .png or .jpg
  double stamp = 0.0;         ///< s, or the frame's number
};

/// A sequence whose images are written in a layout.
struct WrittenRgbd {
  const FrameSource& source;
  const std::filesystem::path& folder;
  int frames;  ///< how many of them

  /// The true pose at a frame's time, as kitti's poses are: interpolated.
  [[nodiscard]] std::optional<Pose> pose(int index) const;
};

/// How a layout is written.
struct RgbdFiles {
  RgbdNames (*names)(int index, double seconds);
  double units;           ///< of depth, a metre
  std::uint16_t none;     ///< written where there is no depth
  bool own_depth_camera;  ///< depth is filmed by miniature_depth_camera
  void (*write_texts)(
      const WrittenRgbd& written);  ///< calibration, lists and truth, when the images are there
  /// All that it writes beside masks, by what an earlier one is known and cleared: parted by blanks, one `*`
  /// each.
  const char* own;
};

/// The depth camera of layouts that have one: 320x240 px, 25 mm beside the colour camera and turned a little.
[[nodiscard]] DepthCamera miniature_depth_camera();

/// A frame's images in a layout. @param frame of the source
/// @returns pixels whose depth 16 bits cannot hold: they are written as not measured
/// @throws InputError for what cannot be written, and for a depth camera of its own where the source cannot
/// be filmed by one
int write_rgbd_frame(const RgbdLayout& layout, const FrameSource& source, const Frame& frame,
                     const std::filesystem::path& folder);

/// Makes the folders that a layout's images lie in.
void make_rgbd_folders(const RgbdLayout& layout, const std::filesystem::path& folder);

/// The files that any layout writes and that a folder holds, by their names alone.
[[nodiscard]] std::vector<std::filesystem::path> rgbd_files_in(const std::filesystem::path& folder);

/// Takes away the folders that a layout makes, as far as they are empty.
void remove_rgbd_folders(const std::filesystem::path& folder);

/// Two lists in the manner of `rgb.txt` and `depth.txt`, of the images that are there.
void write_tum_texts(const WrittenRgbd& written, RgbdNames (*names)(int, double), const char* colour_list,
                     const char* depth_list);

/// A matrix as files have it, a row a line.
[[nodiscard]] std::string matrix_text(const Eigen::Matrix4d& matrix);

/// The matrix of a camera's intrinsics, filled up to 4x4.
[[nodiscard]] Eigen::Matrix4d intrinsic_matrix(const Camera& camera);

}  // namespace stillpoint
