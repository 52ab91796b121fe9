#include "core/sequence/tum_folder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <system_error>

#include "core/error.hpp"
#include "core/sequence/association.hpp"
#include "core/sequence/image_file.hpp"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;

constexpr double kFrameRate = 30.0;  // Hz, of sequences whose stamps are frame numbers
constexpr double kTruthMaxGap =
    0.05;  // s, between the ground-truth poses a frame's pose is interpolated from

void check_folder(const std::string& folder) {
  std::error_code error;
  const fs::file_status status = fs::status(folder, error);
  if (status.type() == fs::file_type::not_found)
    throw InputError(fmt::format("{}: there is no such folder", folder));
  if (error) throw InputError(fmt::format("{}: cannot be opened: {}", folder, error.message()));
  if (!fs::is_directory(status))
    throw InputError(fmt::format("{}: is a file, expected a folder in the TUM RGB-D layout", folder));
  const fs::directory_iterator entries(folder, error);
  if (error) throw InputError(fmt::format("{}: cannot be opened: {}", folder, error.message()));
}

bool is_there(const std::string& path) {
  std::error_code none;
  return fs::exists(path, none);
}

/// `groundtruth.txt`, or the first of ICL-NUIM's `*.gt.freiburg`; nothing when neither is there.
std::optional<std::string> find_ground_truth(const std::string& folder) {
  const std::string usual = (fs::path(folder) / "groundtruth.txt").string();
  if (is_there(usual)) return usual;
  std::vector<std::string> others;
  std::error_code none;
  for (const auto& file : fs::directory_iterator(folder, none))
    if (file.path().string().ends_with(".gt.freiburg")) others.push_back(file.path().string());
  if (others.empty()) return std::nullopt;
  return *std::min_element(others.begin(), others.end());
}

std::vector<double> stamps_of(const std::vector<ListEntry>& entries) {
  std::vector<double> stamps;
  stamps.reserve(entries.size());
  for (const ListEntry& entry : entries) stamps.push_back(entry.timestamp);
  return stamps;
}

}  // namespace

TumFolder::TumFolder(const std::string& folder, const std::optional<Camera>& camera) : folder_(folder) {
  check_folder(folder);
  fs::path whole = fs::absolute(folder).lexically_normal();
  if (whole.filename().empty()) whole = whole.parent_path();
  name_ = whole.filename().string();
  read_lists();
  read_ground_truth();
  settle_stamps();
  choose_camera(camera);
}

std::string TumFolder::path_of(const std::string& file) const { return (fs::path(folder_) / file).string(); }

void TumFolder::read_lists() {
  const std::string associations = path_of("associations.txt"), colours = path_of("rgb.txt");
  if (is_there(associations)) {
    colour_list_ = associations;
    for (ListedPair& pair : read_associations(associations, warnings_))
      frames_.push_back({std::move(pair.colour), std::move(pair.depth), {}});
    has_depth_ = true;
    const auto far = std::find_if(frames_.begin(), frames_.end(), [](const Entry& e) {
      return std::abs(e.colour.timestamp - e.depth->timestamp) >= kAssociationTolerance;
    });
    if (far != frames_.end())
      warnings_.push_back(fmt::format("{}:{}: pairs images {:.3f} s apart; it was taken at its word",
                                      associations, far->colour.line,
                                      std::abs(far->colour.timestamp - far->depth->timestamp)));
  } else if (is_there(colours)) {
    colour_list_ = colours;
    for (ListEntry& entry : read_list(colours, warnings_)) frames_.push_back({std::move(entry), {}, {}});
    if (is_there(path_of("depth.txt"))) {
      join_list("depth.txt", &Entry::depth);
      has_depth_ = true;
    }
  } else {
    throw InputError(fmt::format(
        "{}: holds neither rgb.txt nor associations.txt, expected a folder in the TUM RGB-D layout",
        folder_));
  }
  if (is_there(path_of("mask.txt"))) {
    join_list("mask.txt", &Entry::mask);
    has_masks_ = true;
    const auto gone = [this](const Entry& e) { return e.mask && !is_there(path_of(e.mask->file)); };
    if (const auto first = std::find_if(frames_.begin(), frames_.end(), gone); first != frames_.end())
      warnings_.push_back(fmt::format(
          "{}:{}: {} is missing; {} mask(s) are, and their frames have no true mask", path_of("mask.txt"),
          first->mask->line, first->mask->file, std::count_if(frames_.begin(), frames_.end(), gone)));
  }
}

void TumFolder::join_list(const std::string& list, std::optional<ListEntry> Entry::*part) {
  const std::vector<ListEntry> listed = read_list(path_of(list), warnings_);
  std::vector<double> stamps;
  stamps.reserve(frames_.size());
  for (const Entry& frame : frames_) stamps.push_back(frame.colour.timestamp);
  const auto pairs = associate(stamps, stamps_of(listed));
  for (const AssociatedPair& pair : pairs) frames_[pair.first].*part = listed[pair.second];
  if (pairs.empty())
    warnings_.push_back(fmt::format("{}: none of its stamps is within {} s of a colour image's",
                                    path_of(list), kAssociationTolerance));
}

void TumFolder::read_ground_truth() {
  if (const auto path = find_ground_truth(folder_)) ground_truth_ = read_tum_trajectory(*path, &warnings_);
}

void TumFolder::settle_stamps() {
  std::vector<double> stamps, truth_stamps;
  for (const Entry& frame : frames_) stamps.push_back(frame.colour.timestamp);
  if (!are_frame_numbers(stamps)) return;
  for (const StampedPose& pose : ground_truth_) truth_stamps.push_back(pose.timestamp);
  for (Entry& frame : frames_) frame.colour.timestamp /= kFrameRate;
  std::string sentence = fmt::format("{}: the stamps are frame numbers; they were read as frames at {} Hz",
                                     colour_list_, kFrameRate);
  if (are_frame_numbers(truth_stamps))
    for (StampedPose& pose : ground_truth_) pose.timestamp /= kFrameRate;
  else if (!truth_stamps.empty())
    sentence += ", those of the ground truth as seconds";
  warnings_.push_back(sentence);
}

void TumFolder::choose_camera(const std::optional<Camera>& camera) {
  const fs::path whole = fs::absolute(folder_).lexically_normal();
  if (camera) {
    camera_ = *camera;
  } else if (is_there(path_of("camera.toml"))) {
    camera_ = read_camera(path_of("camera.toml"));
  } else if (const auto own = camera_from_folder_name(name_)) {
    camera_ = *own;
  } else if (const auto parents =
                 camera_from_folder_name((whole.filename().empty() ? whole.parent_path() : whole)
                                             .parent_path()
                                             .filename()
                                             .string())) {
    camera_ = *parents;
  } else {
    camera_ = camera_by_name("ros_default");
    warnings_.push_back(fmt::format("{}: the name tells no camera; {} is assumed", folder_, camera_.name));
  }

  std::string first_problem;
  for (const Entry& frame : frames_) {
    const ImageRead image = read_image(path_of(frame.colour.file));
    if (image.image.empty()) {
      if (first_problem.empty()) first_problem = fmt::format("line {}: {}", frame.colour.line, image.problem);
      continue;
    }
    const cv::Size size = image.image.size();
    if (size == cv::Size(camera_.width, camera_.height)) return;
    warnings_.push_back(
        fmt::format("{}: images are {}x{} px; the intrinsics of camera {} ({}x{} px) were scaled to them",
                    folder_, size.width, size.height, camera_.name, camera_.width, camera_.height));
    camera_ = camera_.scaled_to(size.width, size.height);
    return;
  }
  throw InputError(
      fmt::format("{}: none of its {} images can be read; {}", colour_list_, frames_.size(), first_problem));
}

double TumFolder::timestamp(int index) const { return entry(index).colour.timestamp; }

Frame TumFolder::read(int index) const {
  const Entry& listed = entry(index);
  Frame frame;
  frame.index = index;
  frame.timestamp = listed.colour.timestamp;
  const ImageRead image = read_image(path_of(listed.colour.file));
  frame.problem = image.problem;
  if (image.image.empty()) return frame;
  if (image.image.cols != camera_.width || image.image.rows != camera_.height) {
    frame.problem =
        fmt::format("{} is {}x{} px, but the sequence's images are {}x{} px", path_of(listed.colour.file),
                    image.image.cols, image.image.rows, camera_.width, camera_.height);
    return frame;
  }
  const cv::Mat colour = to_8bit(image.image);
  frame.gray = to_gray(colour);
  if (colour.channels() == 3) frame.colour = colour;
  if (has_depth_) read_depth(listed, frame);
  return frame;
}

void TumFolder::read_depth(const Entry& listed, Frame& frame) const {
  if (!listed.depth) {
    frame.problem = fmt::format("no depth image within {} s", kAssociationTolerance);
    return;
  }
  const std::string path = path_of(listed.depth->file);
  ImageRead depth = read_image(path);
  if (depth.image.empty())
    frame.problem = depth.problem;
  else if (depth.image.type() != CV_16UC1)
    frame.problem = fmt::format("{} holds {} channel(s) of {} bits, expected depth as 1 channel of 16 bits",
                                path, depth.image.channels(), 8 * depth.image.elemSize1());
  else if (depth.image.size() != frame.gray.size())
    frame.problem = fmt::format("{} is {}x{} px, but its colour image is {}x{} px", path, depth.image.cols,
                                depth.image.rows, frame.gray.cols, frame.gray.rows);
  else if (cv::countNonZero(depth.image) == 0)
    frame.problem = fmt::format("{} is zero everywhere: no depth was measured", path);
  else {
    depth.image.convertTo(frame.depth, CV_32F, 1.0 / camera_.depth_scale);
    frame.depth_timestamp = listed.depth->timestamp;
  }
}

FrameTruth TumFolder::truth(int index) const {
  const Entry& listed = entry(index);
  FrameTruth truth;
  truth.world_from_camera = interpolate(ground_truth_, listed.colour.timestamp, kTruthMaxGap);
  if (!truth.world_from_camera)
    if (const auto near = nearest_pose(ground_truth_, listed.colour.timestamp, kAssociationTolerance))
      truth.world_from_camera = ground_truth_[*near].world_from_camera;
  if (listed.mask) {
    const ImageRead mask = read_image(path_of(listed.mask->file));
    if (!mask.image.empty() && mask.image.cols == camera_.width && mask.image.rows == camera_.height)
      truth.moving = to_gray(to_8bit(mask.image)) > 127;
  }
  return truth;
}

}  // namespace stillpoint
