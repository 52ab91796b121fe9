#include "core/sequence/rgbd/rgbd_recording.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "core/error.hpp"
#include "core/sequence/folder_camera.hpp"
#include "core/text_file.hpp"

namespace stillpoint {

std::span<const RgbdLayout* const> rgbd_layouts() {
  static constexpr std::array kLayouts = {
      &kSevenScenesLayout, &kReplicaLayout, &kScanNetLayout, &kOpenLorisLayout, &kEth3dLayout,
      &kOpen3dLayout,      &kRedwoodLayout, &kIclLayout,     &kBonnLayout,      &kUnregisteredLayout};
  return kLayouts;
}

const RgbdLayout& rgbd_layout_by_name(const std::string& name) {
  std::vector<std::string> names;
  for (const RgbdLayout* layout : rgbd_layouts()) {
    if (name == layout->name) return *layout;
    names.emplace_back(layout->name);
  }
  throw InputError(fmt::format("--layout {}: expected tum, {}", name, fmt::join(names, ", ")));
}

std::optional<RgbdRecording> read_rgbd_recording(const FileStore& folder, const OpenOptions& options) {
  for (const RgbdLayout* layout : rgbd_layouts())
    if (layout->read != nullptr)
      if (auto recording = layout->read(folder, options)) return recording;
  return std::nullopt;
}

Camera given_camera_or(const FileStore& folder, const OpenOptions& options,
                       const std::function<Camera()>& own) {
  if (options.camera) return *options.camera;
  if (auto camera = camera_in_folder(folder)) return *camera;
  return own();
}

int pixels_of(double number) {
  constexpr double kMost = 1e6;  // px: what claims more is not converted to int
  return number > 0 && number < kMost ? static_cast<int>(number) : 0;
}

FolderLists numbered_images(const FileStore& folder, ImageList colours, ImageList depths) {
  FolderLists lists;
  lists.colours = std::move(colours);
  if (depths.entries.empty())
    lists.warnings.push_back(fmt::format("{}: has no depth images", folder.place()));
  else
    lists.depths = std::move(depths);
  return lists;
}

Eigen::Matrix4d read_matrix(const FileStore& folder, const std::string& name) {
  std::vector<double> numbers;
  bool whole = true;
  for (const TextLine& line : text_lines(folder.read_text(name)))
    for (const std::string_view column : split_columns(line.text)) {
      const auto number = parse_number(column);
      whole = whole && number.has_value();
      numbers.push_back(number.value_or(0.0));
    }
  const bool is_small = numbers.size() == 9;
  if (!whole || (numbers.size() != 16 && !is_small))
    throw InputError(fmt::format("{}: is no 4x4 matrix of numbers", folder.path_of(name)));
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  const Eigen::Index side = is_small ? 3 : 4;
  for (Eigen::Index i = 0; i < side * side; ++i)
    matrix(i / side, i % side) = numbers[static_cast<std::size_t>(i)];
  return matrix;
}

FolderTruth read_pose_files(const FileStore& folder, const ImageList& images, const std::string& folder_name,
                            const std::function<std::string(const ListEntry&)>& name_of) {
  FolderTruth truth;
  truth.path = folder.path_of(folder_name);
  int missing = 0, lost = 0;
  std::string first_bad;
  for (const ListEntry& image : images.entries) {
    const std::string name = name_of(image);
    if (!folder.is_there(name)) {
      ++missing;
      continue;
    }
    std::optional<Pose> pose;
    try {
      const Eigen::Matrix4d matrix = read_matrix(folder, name);
      lost += matrix.allFinite() ? 0 : 1;
      if (!matrix.allFinite()) continue;
      pose = rigid_pose(matrix);
      if (!pose && first_bad.empty()) first_bad = fmt::format("{}: is no rigid motion", folder.path_of(name));
    } catch (const InputError& error) {
      if (first_bad.empty()) first_bad = error.what();
    }
    if (pose) truth.poses.push_back({image.timestamp, *pose});
  }
  if (lost > 0)
    truth.warnings.push_back(fmt::format("{}: {} of {} poses are not finite: the camera was lost there",
                                         truth.path, lost, images.entries.size()));
  if (missing > 0 && missing < static_cast<int>(images.entries.size()))
    truth.warnings.push_back(
        fmt::format("{}: {} of {} images have no pose", truth.path, missing, images.entries.size()));
  const bool is_none = truth.poses.empty() && missing < static_cast<int>(images.entries.size());
  if (!first_bad.empty()) (is_none ? truth.why_not : truth.warnings.emplace_back()) = first_bad;
  if (is_none && truth.why_not.empty())
    truth.why_not = fmt::format("{}: none of its poses is finite", truth.path);
  return truth;
}

}  // namespace stillpoint
