#include "core/geometry/camera.hpp"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <Eigen/LU>
#include <algorithm>
#include <cctype>
#include <functional>
#include <utility>
#include <vector>

#include "core/error.hpp"
#include "core/geometry/camera_yaml.hpp"
#include "core/geometry/pixel_conventions.hpp"

namespace stillpoint {
namespace {

Camera make(const char* name, double fx, double fy, double cx, double cy, double depth_scale = 5000.0) {
  Camera camera;
  camera.name = name;
  camera.fx = fx, camera.fy = fy, camera.cx = cx, camera.cy = cy;
  camera.depth_scale = depth_scale;
  return camera;
}

Camera with_distortion(Camera camera, double k1, double k2, double p1, double p2, double k3) {
  camera.k1 = k1, camera.k2 = k2, camera.p1 = p1, camera.p2 = p2, camera.k3 = k3;
  return camera;
}

/// The first Kinect's and the Xtion's colour sensor, which TUM's and Bonn's sequences were filmed with, takes
/// most of the time between frames to read an image. Of freiburg1's and freiburg3's it was measured
/// (assets/cameras has how); of the others it is assumed.
constexpr double kAssumedReadout = 0.030;  // s

Camera with_readout(Camera camera, double readout_s = kAssumedReadout) {
  camera.readout_s = readout_s;
  return camera;
}

Camera with_depth_delay(Camera camera, double delay_s) {
  camera.depth_delay_s = delay_s;
  return camera;
}

Camera with_freiburg1_times(Camera camera) {
  camera.readout_s = 0.025, camera.depth_readout_s = 0.033;
  camera.stamp_delay_s = -0.007, camera.depth_delay_s = -0.028;
  return camera;
}

bool is_yaml(std::string_view path) { return path.ends_with(".yaml") || path.ends_with(".yml"); }

/// A name's words in small letters: runs of letters and digits.
std::vector<std::string> words_of(std::string_view name) {
  std::vector<std::string> words(1);
  for (const char c : name) {
    if (std::isalnum(static_cast<unsigned char>(c)) != 0)
      words.back() += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    else if (!words.back().empty())
      words.emplace_back();
  }
  if (words.back().empty()) words.pop_back();
  return words;
}

// At most: a handful of rounds do unless distortion folds the image. A step that makes it worse is halved.
constexpr int kNewtonRounds = 30, kHalvings = 8;
constexpr double kNewtonResidual = 1e-13;  // of the image plane one focal length away

/// Brown and Conrady's distortion of a point of the image plane one focal length away, as OpenCV has it, and
/// its derivative.
Eigen::Vector2d distorted_point(const Camera& c, const Eigen::Vector2d& point, Eigen::Matrix2d* derivative) {
  const double x = point.x(), y = point.y();
  const double r2 = x * x + y * y;
  const double radial = 1.0 + r2 * (c.k1 + r2 * (c.k2 + r2 * c.k3));
  if (derivative != nullptr) {
    const double slope = 2.0 * (c.k1 + r2 * (2.0 * c.k2 + 3.0 * r2 * c.k3));  // of radial, by r2, times 2
    const double mixed = x * y * slope + 2.0 * c.p1 * x + 2.0 * c.p2 * y;
    *derivative << radial + x * x * slope + 2.0 * c.p1 * y + 6.0 * c.p2 * x, mixed, mixed,
        radial + y * y * slope + 6.0 * c.p1 * y + 2.0 * c.p2 * x;
  }
  return {x * radial + 2.0 * c.p1 * x * y + c.p2 * (r2 + 2.0 * x * x),
          y * radial + c.p1 * (r2 + 2.0 * y * y) + 2.0 * c.p2 * x * y};
}

}  // namespace

bool Camera::has_distortion() const { return k1 != 0 || k2 != 0 || p1 != 0 || p2 != 0 || k3 != 0; }

cv::Matx33d Camera::matrix() const { return {fx, 0, cx, 0, fy, cy, 0, 0, 1}; }

Eigen::Vector2d Camera::undistorted(const Eigen::Vector2d& pixel) const {
  if (!has_distortion()) return pixel;
  const Eigen::Vector2d target((pixel.x() - cx) / fx, (pixel.y() - cy) / fy);
  Eigen::Vector2d point = target;
  Eigen::Matrix2d jacobian;
  Eigen::Vector2d residual = distorted_point(*this, point, &jacobian) - target;
  for (int round = 0; round < kNewtonRounds && residual.norm() > kNewtonResidual; ++round) {
    const Eigen::Vector2d step = jacobian.inverse() * residual;
    if (!step.allFinite()) break;
    // A full step may leap over a fold; half of it, and half again, then does not.
    double share = 1.0;
    bool nearer = false;
    for (int halving = 0; halving < kHalvings && !nearer; ++halving, share *= 0.5) {
      Eigen::Matrix2d there;
      const Eigen::Vector2d left = distorted_point(*this, point - share * step, &there) - target;
      nearer = left.norm() < residual.norm();
      if (nearer) point -= share * step, residual = left, jacobian = there;
    }
    if (!nearer) break;
  }
  return {fx * point.x() + cx, fy * point.y() + cy};
}

std::vector<cv::Point2f> Camera::undistort(const std::vector<cv::Point2f>& pixels) const {
  if (!has_distortion()) return pixels;
  std::vector<cv::Point2f> result;
  result.reserve(pixels.size());
  for (const cv::Point2f& pixel : pixels) {
    const Eigen::Vector2d straight = undistorted({pixel.x, pixel.y});
    result.emplace_back(static_cast<float>(straight.x()), static_cast<float>(straight.y()));
  }
  return result;
}

Eigen::Vector2d Camera::distort(const Eigen::Vector2d& undistorted_pixel) const {
  if (!has_distortion()) return undistorted_pixel;
  const Eigen::Vector2d point =
      distorted_point(*this, {(undistorted_pixel.x() - cx) / fx, (undistorted_pixel.y() - cy) / fy}, nullptr);
  return {fx * point.x() + cx, fy * point.y() + cy};
}

Camera Camera::scaled_to(int new_width, int new_height) const {
  Camera scaled = *this;
  const double sx = static_cast<double>(new_width) / width, sy = static_cast<double>(new_height) / height;
  scaled.width = new_width, scaled.height = new_height;
  scaled.fx *= sx, scaled.fy *= sy;
  scaled.cx = upsampled(cx, sx), scaled.cy = upsampled(cy, sy);
  return scaled;
}

const std::vector<Camera>& known_cameras() {
  // freiburg2's depth reads about 4 % short at 5000 per metre; 5208 is what ORB-SLAM2 uses.
  static const std::vector<Camera> cameras = {
      with_freiburg1_times(with_distortion(make("freiburg1", 517.306408, 516.469215, 318.643040, 255.313989),
                                           0.262383, -0.953104, -0.005358, 0.002628, 1.163314)),
      with_readout(with_distortion(make("freiburg2", 520.908620, 521.007327, 325.141442, 249.701764, 5208.0),
                                   0.231222, -0.784899, -0.003257, -0.000105, 0.917205)),
      with_depth_delay(with_readout(make("freiburg3", 535.4, 539.2, 320.1, 247.6), 0.0325), -0.032),
      make("icl_nuim", 481.20, 480.00, 319.50, 239.50),
      with_readout(with_distortion(make("bonn", 542.822841, 542.576870, 315.593520, 237.756098), 0.039903,
                                   -0.099343, -0.000730, -0.000144, 0.0)),
      make("generated", 535.4, 539.2, 320.1, 247.6),
      make("ros_default", 525.0, 525.0, 319.5, 239.5),
  };
  return cameras;
}

Camera camera_by_name(std::string_view name) {
  std::vector<std::string> names;
  for (const Camera& camera : known_cameras()) {
    if (camera.name == name) return camera;
    names.push_back(camera.name);
  }
  throw InputError(fmt::format("there is no camera '{}'; the cameras are: {} (or give a .toml or .yaml file)",
                               name, fmt::join(names, ", ")));
}

std::optional<Camera> camera_from_folder_name(std::string_view folder_name) {
  const std::vector<std::string> words = words_of(folder_name);
  const auto has = [&](const std::string& word) {
    return std::find(words.begin(), words.end(), word) != words.end();
  };
  for (const char* digit : {"1", "2", "3"})
    for (const std::string& word : words)
      for (const std::string& name : {std::string("freiburg") + digit, std::string("fr") + digit})
        if (word == name ||
            (word.starts_with(name) && std::isdigit(static_cast<unsigned char>(word[name.size()])) == 0))
          return camera_by_name(std::string("freiburg") + digit);
  if (has("bonn")) return camera_by_name("bonn");
  // ICL-NUIM's own names: living_room_traj2_frei_png, office_room_traj0_loop, traj3_frei_png.
  const bool is_trajectory = std::any_of(words.begin(), words.end(), [](const std::string& word) {
    return word.size() == 5 && word.starts_with("traj") && word[4] >= '0' && word[4] <= '3';
  });
  if (has("icl") || has("iclnuim") || (is_trajectory && (has("room") || has("frei"))))
    return camera_by_name("icl_nuim");
  return std::nullopt;
}

namespace {

constexpr double kLongestBaseline = 100.0;  // m: what is longer was given in mm
constexpr double kLongestTime = 0.2;        // s, of readouts and delays

using Reals = std::vector<std::pair<const char*, double*>>;

/// What both a camera and a depth camera have.
Reals intrinsics_of(Camera& camera) {
  return {{"fx", &camera.fx}, {"fy", &camera.fy}, {"cx", &camera.cx}, {"cy", &camera.cy}, {"k1", &camera.k1},
          {"k2", &camera.k2}, {"p1", &camera.p1}, {"p2", &camera.p2}, {"k3", &camera.k3}};
}

/// Takes a key of a camera's table. @param where names it in messages
/// @returns false where the key is none of these
bool take_key(const std::string& where, std::string_view key, const toml::node& node, const Reals& reals,
              Camera& camera) {
  for (const auto& [name, target] : reals)
    if (key == name) {
      const auto value = node.is_number() ? node.value<double>() : std::nullopt;
      if (!value || !std::isfinite(*value)) throw InputError(where + " takes a finite number");
      *target = *value;
      return true;
    }
  if (key != "width" && key != "height") return false;
  const auto value = node.value_exact<std::int64_t>();
  if (!value || *value < 32 || *value > 16384)
    throw InputError(where + " takes a whole number of px from 32 to 16384");
  (key == "width" ? camera.width : camera.height) = static_cast<int>(*value);
  return true;
}

/// A pose as rows of four numbers. @param where names it in messages
Pose pose_of_rows(const std::string& where, const toml::node& node) {
  const toml::array* const rows = node.as_array();
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  bool whole = rows != nullptr && (rows->size() == 3 || rows->size() == 4);
  for (std::size_t i = 0; whole && i < rows->size(); ++i) {
    const toml::array* const row = rows->get(i)->as_array();
    whole = row != nullptr && row->size() == 4;
    for (std::size_t k = 0; whole && k < 4; ++k) {
      const toml::node& number = *row->get(k);
      const auto value = number.is_number() ? number.value<double>() : std::nullopt;
      whole = value.has_value();
      matrix(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k)) = value.value_or(0.0);
    }
  }
  if (!whole) throw InputError(where + " takes three or four rows of four numbers, [[r, r, r, t], …]");
  const auto pose = rigid_pose(matrix);
  if (!pose) throw InputError(where + " is no rigid motion");
  return *pose;
}

std::shared_ptr<const DepthCamera> depth_camera_from_toml(const std::string& path, const toml::node& node) {
  const toml::table* const table = node.as_table();
  if (table == nullptr)
    throw InputError(
        fmt::format("{}:{}: depth_camera is a table, [depth_camera]", path, node.source().begin.line));
  DepthCamera depth;
  depth.camera.name = "depth";
  for (auto&& [key, value] : *table) {
    const std::string where = fmt::format("{}:{}: {}", path, value.source().begin.line, key.str());
    if (key.str() == "colour_from_depth")
      depth.colour_from_depth = pose_of_rows(where, value);
    else if (!take_key(where, key.str(), value, intrinsics_of(depth.camera), depth.camera))
      throw InputError(where + " is no key of a depth camera");
  }
  for (const char* needed : {"fx", "fy", "cx", "cy", "width", "height"})
    if (!table->contains(needed)) throw InputError(fmt::format("{}: [depth_camera] has no {}", path, needed));
  if (depth.camera.fx <= 0 || depth.camera.fy <= 0)
    throw InputError(fmt::format("{}: fx and fy of [depth_camera] must be above 0", path));
  return std::make_shared<const DepthCamera>(std::move(depth));
}

/// The camera of a TOML file. @param parse gives its table
Camera camera_from_toml(const std::string& path, const std::function<toml::table()>& parse) {
  toml::table table;
  try {
    table = parse();
  } catch (const toml::parse_error& error) {
    throw InputError(fmt::format("{}:{}: not a readable camera file: {}", path, error.source().begin.line,
                                 std::string(error.description())));
  }
  Camera camera;
  camera.name = path;
  double depth_readout_s = 0.0;
  Reals reals = intrinsics_of(camera);
  reals.insert(reals.end(), {{"depth_scale", &camera.depth_scale},
                             {"readout_s", &camera.readout_s},
                             {"stamp_delay_s", &camera.stamp_delay_s},
                             {"depth_readout_s", &depth_readout_s},
                             {"depth_delay_s", &camera.depth_delay_s},
                             {"baseline_m", &camera.baseline_m}});
  for (auto&& [key, node] : table) {
    const std::string where = fmt::format("{}:{}: {}", path, node.source().begin.line, key.str());
    if (key.str() == "name") {
      if (!node.is_string()) throw InputError(where + " takes a text");
      camera.name = node.value_or(std::string());
    } else if (key.str() == "depth_camera") {
      camera.depth_camera = depth_camera_from_toml(path, node);
    } else if (!take_key(where, key.str(), node, reals, camera)) {
      throw InputError(where + " is no key of a camera");
    }
  }
  for (const char* needed : {"fx", "fy", "cx", "cy"})
    if (!table.contains(needed)) throw InputError(fmt::format("{}: the camera has no {}", path, needed));
  if (camera.fy < 0 && camera.fx > 0)
    throw InputError(
        fmt::format("{}: fy is negative, as in ICL-NUIM's own calibration: give it without the sign, and "
                    "`--truth mirrored-y` for its poses",
                    path));
  if (camera.fx <= 0 || camera.fy <= 0 || camera.depth_scale <= 0)
    throw InputError(fmt::format("{}: fx, fy and depth_scale must be above 0", path));
  if (table.contains("depth_readout_s")) camera.depth_readout_s = depth_readout_s;
  for (const auto& [name, seconds] :
       {std::pair("readout_s", camera.readout_s),
        std::pair("depth_readout_s", camera.depth_readout_s.value_or(0.0)),
        std::pair("stamp_delay_s", camera.stamp_delay_s), std::pair("depth_delay_s", camera.depth_delay_s)})
    if (std::abs(seconds) > kLongestTime)
      throw InputError(fmt::format("{}: {} is given in seconds, from {:g} to {:g}", path, name, -kLongestTime,
                                   kLongestTime));
  if (camera.baseline_m < 0 || camera.baseline_m > kLongestBaseline)
    throw InputError(
        fmt::format("{}: baseline_m is given in metres, from 0 to {:g}", path, kLongestBaseline));
  return camera;
}

}  // namespace

Camera read_camera(const std::string& path) {
  if (is_yaml(path)) return read_yaml_camera(path);
  return camera_from_toml(path, [&] { return toml::parse_file(path); });
}

Camera read_camera_text(const std::string& path, const std::string& text) {
  if (is_yaml(path)) return read_yaml_camera_text(path, text);
  return camera_from_toml(path, [&] { return toml::parse(text, path); });
}

Camera camera_from_argument(const std::string& argument) {
  return argument.ends_with(".toml") || is_yaml(argument) ? read_camera(argument) : camera_by_name(argument);
}

}  // namespace stillpoint
