#include <fmt/format.h>

#include <Eigen/Dense>
#include <cmath>
#include <map>

#include "core/error.hpp"
#include "core/sequence/stereo/stereo_recording.hpp"
#include "core/text_file.hpp"

namespace stillpoint {
namespace {

constexpr double kRate = 10.0;  // Hz, of KITTI's cameras

using Projection = Eigen::Matrix<double, 3, 4>;

struct Pair {
  int left, right;  // camera numbers
  [[nodiscard]] std::string folder(int camera) const { return fmt::format("image_{}", camera); }
};
constexpr Pair kPairs[] = {{0, 1}, {2, 3}};

/// The pair of folders to read: grey where both are there, otherwise colour, otherwise what there is of
/// either.
std::optional<Pair> pair_in(const FileStore& folder) {
  const auto is_there = [&](const Pair& pair, int camera) { return folder.is_folder(pair.folder(camera)); };
  for (const Pair& pair : kPairs)
    if (is_there(pair, pair.left) && is_there(pair, pair.right)) return pair;
  for (const Pair& pair : kPairs)
    if (is_there(pair, pair.left) || is_there(pair, pair.right)) return pair;
  return std::nullopt;
}

/// `P0: 12 numbers`, … by camera.
std::map<int, Projection> projections_of(const FileStore& folder, const std::string& name) {
  std::map<int, Projection> projections;
  for (const TextLine& line : text_lines(folder.read_text(name))) {
    if (line.text.size() < 3 || line.text[0] != 'P' || line.text[1] < '0' || line.text[1] > '3') continue;
    const std::size_t colon = line.text.find(':');
    const std::string numbers = colon == std::string::npos ? "" : line.text.substr(colon + 1);
    const auto columns = split_columns(numbers);
    Projection p = Projection::Zero();
    for (std::size_t i = 0; i < columns.size() && i < 12; ++i)
      p(static_cast<Eigen::Index>(i / 4), static_cast<Eigen::Index>(i % 4)) =
          parse_number(columns[i]).value_or(std::nan(""));
    if (columns.size() != 12 || !p.allFinite())
      throw InputError(fmt::format("{}:{}: found {}, expected the 12 numbers of a projection, P0: fx 0 cx …",
                                   folder.path_of(name), line.number, in_quotes(line.text)));
    projections[line.text[1] - '0'] = p;
  }
  return projections;
}

const Projection& projection(const std::map<int, Projection>& all, int camera, const std::string& path) {
  const auto found = all.find(camera);
  if (found == all.end())
    throw InputError(fmt::format("{}: has no P{}, the projection of image_{}", path, camera, camera));
  if (found->second(0, 0) <= 0 || found->second(1, 1) <= 0)
    throw InputError(fmt::format("{}: P{} has a focal length of 0 or less", path, camera));
  return found->second;
}

/// Where camera 0's origin lies for a camera: K⁻¹ p, p the fourth column.
Eigen::Vector3d offset(const Projection& p) { return p.leftCols<3>().inverse() * p.col(3); }

Camera camera_of(const FileStore& folder, const Pair& pair, StereoRecording& recording) {
  constexpr const char* kName = "calib.txt";
  const std::string path = folder.path_of(kName);
  if (!folder.is_there(kName))
    throw InputError(
        fmt::format("{}: is missing; it holds P0 to P3, without which a KITTI sequence has no scale", path));
  const auto all = projections_of(folder, kName);
  const Projection &left = projection(all, pair.left, path), &right = projection(all, pair.right, path);
  constexpr double kSame = 1e-3;  // px: what printing the numbers leaves of equal ones
  if ((left.leftCols<3>() - right.leftCols<3>()).cwiseAbs().maxCoeff() > kSame)
    throw InputError(
        fmt::format("{}: P{} and P{} have different focal lengths or centres, expected a rectified pair",
                    path, pair.left, pair.right));
  const Eigen::Vector3d right_from_left = offset(right) - offset(left);
  Camera camera;
  camera.name = "kitti";
  camera.fx = left(0, 0), camera.fy = left(1, 1), camera.cx = left(0, 2), camera.cy = left(1, 2);
  camera.baseline_m = -right_from_left.x();
  if (camera.baseline_m <= 0)
    throw InputError(fmt::format("{}: by P{} and P{} the right camera lies to the left of the left one", path,
                                 pair.left, pair.right));
  // Poses are camera 0's.
  recording.body_from_camera.translation() = -offset(left);
  return camera;
}

void stamp(const FileStore& folder, StereoRecording& recording) {
  constexpr const char* kTimes = "times.txt";
  FolderLists& lists = recording.lists;
  if (folder.is_there(kTimes)) {
    const std::vector<double> times = read_times(folder, kTimes);
    stamp_by_times(folder.path_of(kTimes), times, lists);
    recording.row_stamps = times;
    return;
  }
  for (ImageList* list : {&lists.colours, &*lists.depths})
    for (ListEntry& entry : list->entries) entry.timestamp /= kRate;
  for (int row = 0; row <= static_cast<int>(lists.colours.entries.back().timestamp * kRate + 0.5); ++row)
    recording.row_stamps.push_back(row / kRate);
  lists.warnings.push_back(fmt::format("{}: is missing; the images' numbers were read as frames at {:g} Hz",
                                       folder.path_of(kTimes), kRate));
}

/// Poses beside the images, or where the benchmark has them.
std::string truth_of(const FileStore& folder) {
  for (const std::string& name :
       {std::string("poses.txt"), fmt::format("../../poses/{}.txt", folder.own_names()[0])})
    if (folder.is_file(name)) return name;
  return {};
}

}  // namespace

std::optional<StereoRecording> read_kitti(const FileStore& folder, const OpenOptions& options) {
  const auto pair = pair_in(folder);
  if (!pair) return std::nullopt;
  const auto list = [&](int camera, int other) {
    const std::string name = pair->folder(camera);
    ImageList images = images_of(folder, name);
    if (images.entries.empty())
      throw InputError(fmt::format(
          "{}: {}; depth comes of two images a frame, and {} holds the other one", folder.path_of(name),
          folder.is_folder(name) ? "holds no images" : "is missing", pair->folder(other)));
    return images;
  };
  StereoRecording recording;
  recording.lists.stereo = true;
  recording.lists.colours = list(pair->left, pair->right);
  recording.lists.depths = list(pair->right, pair->left);
  recording.camera = options.camera ? *options.camera : camera_of(folder, *pair, recording);
  if (!options.camera) {
    const cv::Size size = first_size(folder, recording.lists.colours);
    recording.camera.width = size.width, recording.camera.height = size.height;
  }
  stamp(folder, recording);
  recording.truth = truth_of(folder);
  recording.is_pose_a_row = !recording.truth.empty();
  return recording;
}

}  // namespace stillpoint
