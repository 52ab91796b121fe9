#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>

#include "core/sequence/file_store.hpp"
#include "core/sequence/folder_lists.hpp"
#include "core/sequence/folder_truth.hpp"
#include "core/sequence/rgbd/write_rgbd.hpp"
#include "core/sequence/source.hpp"

namespace stillpoint {

// RGB-D recordings as they are published, where they differ from the TUM layout in more than names. A layout
// is a file here, which knows how it is read and how a generated sequence is written in it, and a line in
// rgbd_layouts().

inline constexpr double kMillimetreScale = 1000.0;  ///< depth image units a metre

/// What a folder (or an archive of one) of another layout says. What it leaves open is read as for a folder
/// in the TUM layout.
struct RgbdRecording {
  std::optional<FolderLists> lists;  ///< nothing: as folder_lists.hpp finds them
  std::optional<StampUnit> unit;     ///< of the stamps of `lists`; nothing: they tell it themselves
  std::optional<Camera> camera;      ///< with its depth camera; nothing: as folder_camera.hpp finds it
  /// Poses at the stamps of images of `lists`, in the unit of those. Nothing: as folder_truth.hpp finds it.
  std::optional<FolderTruth> truth;
  Pose body_from_camera = Pose::Identity();  ///< of the body whose poses the truth has, from the camera
  std::string no_truth;                      ///< why what is there cannot be used, one sentence
};

/// One layout.
struct RgbdLayout {
  const char* name;  ///< as `--layout` takes it
  /// What lies in the folder, where it is of this layout. Null: the layout is read as the TUM layout is.
  /// Throws InputError for one that cannot be used.
  std::optional<RgbdRecording> (*read)(const FileStore& folder, const OpenOptions& options);
  RgbdFiles files;  ///< how it is written
};

extern const RgbdLayout kBonnLayout;          ///< Bonn RGB-D Dynamic: the truth is a marker body's
extern const RgbdLayout kEth3dLayout;         ///< ETH3D SLAM
extern const RgbdLayout kIclLayout;           ///< ICL-NUIM: the truth is mirrored in y
extern const RgbdLayout kOpen3dLayout;        ///< Open3D's readers of Azure Kinect and RealSense
extern const RgbdLayout kOpenLorisLayout;     ///< OpenLORIS-Scene
extern const RgbdLayout kRedwoodLayout;       ///< Redwood, read as Open3D's
extern const RgbdLayout kReplicaLayout;       ///< Replica as NICE-SLAM rendered it
extern const RgbdLayout kScanNetLayout;       ///< ScanNet as its SensReader exports it
extern const RgbdLayout kSevenScenesLayout;   ///< 7-Scenes
extern const RgbdLayout kUnregisteredLayout;  ///< the TUM layout with a depth camera of its own

/// All of them, in the order in which a folder is asked for them.
[[nodiscard]] std::span<const RgbdLayout* const> rgbd_layouts();

/// @throws InputError naming the layouts there are
[[nodiscard]] const RgbdLayout& rgbd_layout_by_name(const std::string& name);

/// Whichever of these the folder is. @throws InputError for one that cannot be used
[[nodiscard]] std::optional<RgbdRecording> read_rgbd_recording(const FileStore& folder,
                                                               const OpenOptions& options);

/// The camera that the user gave or put into the folder (`camera.toml`, `camera.yaml`), otherwise the
/// layout's own. @param own is asked only then
[[nodiscard]] Camera given_camera_or(const FileStore& folder, const OpenOptions& options,
                                     const std::function<Camera()>& own);

/// A size (px) that a file gives as a number of any kind; 0, which check_camera refuses, for what is none.
[[nodiscard]] int pixels_of(double number);

/// Colour and depth images, each stamped by the number in its name. Where there are no depth images it is
/// told.
[[nodiscard]] FolderLists numbered_images(const FileStore& folder, ImageList colours, ImageList depths);

/// The 4x4 matrix of a text file, row by row; 3x3 ones are filled up. May hold what is not finite.
/// @throws InputError for a file that cannot be read or is none
[[nodiscard]] Eigen::Matrix4d read_matrix(const FileStore& folder, const std::string& name);

/// Poses of one file an image, the 4x4 matrix of camera to world. A pose that is missing, cannot be read or
/// is not finite (the camera was lost) costs that pose, and is counted.
/// @param images whose stamps the poses get; @param folder_name names the poses in messages
/// @param name_of the name of an image's pose
[[nodiscard]] FolderTruth read_pose_files(const FileStore& folder, const ImageList& images,
                                          const std::string& folder_name,
                                          const std::function<std::string(const ListEntry&)>& name_of);

}  // namespace stillpoint
