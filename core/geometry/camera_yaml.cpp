#include "core/geometry/camera_yaml.hpp"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <fstream>
#include <optional>
#include <sstream>
#include <vector>

#include "core/error.hpp"
#include "core/text_file.hpp"

namespace stillpoint {
namespace {

/// The file as YAML 1.2 has it: OpenCV's first line, `%YAML:1.0`, is none.
YAML::Node load(const std::string& path, std::string content) {
  // The line is kept, empty, so that faults keep their line.
  if (content.starts_with("%YAML")) content.erase(0, content.find('\n'));
  try {
    return YAML::Load(content);
  } catch (const YAML::Exception& error) {
    throw InputError(
        fmt::format("{}:{}: not a readable camera file: {}", path, error.mark.line + 1, error.msg));
  }
}

class YamlReader {
 public:
  YamlReader(const std::string& path, std::string text) : path_(path), root_(load(path, std::move(text))) {
    if (!root_.IsMap()) throw InputError(fmt::format("{}: no camera file: no keys with values", path));
    camera_.name = path;
  }

  Camera read() {
    if (has("Camera.fx") || has("Camera1.fx"))
      read_orb_slam(has("Camera1.fx") ? "Camera1." : "Camera.");
    else if (const YAML::Node kalibr = first_camera(); kalibr)
      read_intrinsics(kalibr);
    else if (root_["camera_matrix"])
      read_matrix();
    else
      throw InputError(
          fmt::format("{}: names no camera, expected Camera.fx (ORB-SLAM), cam0 with intrinsics (Kalibr), "
                      "intrinsics (EuRoC) or "
                      "camera_matrix (ROS, OpenCV)",
                      path_));
    if (camera_.fx <= 0 || camera_.fy <= 0 || camera_.depth_scale <= 0)
      throw InputError(fmt::format("{}: fx, fy and the depth factor must be above 0", path_));
    return camera_;
  }

  [[nodiscard]] Pose body_from_sensor() const {
    if (!root_["T_BS"])
      throw InputError(fmt::format("{}: has no T_BS, where the sensor sits on its body", path_));
    const auto values = numbers(root_["T_BS"], "T_BS", 16);
    Pose pose;
    for (int i = 0; i < 16; ++i) pose.matrix()(i / 4, i % 4) = values[static_cast<std::size_t>(i)];
    constexpr double kRounding = 1e-3;  // of a matrix's numbers: what printing them leaves
    const Eigen::Matrix3d turn = pose.linear();
    if (!(turn * turn.transpose()).isIdentity(kRounding) || turn.determinant() < 0 ||
        !pose.matrix().row(3).isApprox(Eigen::RowVector4d(0, 0, 0, 1), kRounding))
      throw InputError(fmt::format("{}: T_BS is no rigid motion", path_));
    return normalised(pose);
  }

 private:
  /// A value by its dotted key: written so, or as a map in a map.
  [[nodiscard]] YAML::Node at(const std::string& key) const {
    if (YAML::Node whole = root_[key]; whole) return whole;
    const auto dot = key.find('.');
    if (dot == std::string::npos) return YAML::Node(YAML::NodeType::Undefined);
    const YAML::Node map = root_[key.substr(0, dot)];
    return map && map.IsMap() ? map[key.substr(dot + 1)] : YAML::Node(YAML::NodeType::Undefined);
  }
  [[nodiscard]] bool has(const std::string& key) const { return at(key).IsDefined(); }

  [[nodiscard]] double number(const YAML::Node& node, const std::string& key) const {
    double value = 0;
    try {
      value = node.as<double>();
    } catch (const YAML::Exception&) {
      throw InputError(fmt::format("{}:{}: {} takes a number", path_, node.Mark().line + 1, key));
    }
    if (!std::isfinite(value))
      throw InputError(fmt::format("{}:{}: {} takes a finite number", path_, node.Mark().line + 1, key));
    return value;
  }
  void take(const std::string& key, double& target, bool needed = false) const {
    if (const YAML::Node node = at(key); node)
      target = number(node, key);
    else if (needed)
      throw InputError(fmt::format("{}: the camera has no {}", path_, key));
  }
  [[nodiscard]] std::vector<double> numbers(const YAML::Node& node, const std::string& key,
                                            std::size_t least) const {
    const YAML::Node list = node && node.IsMap() ? node["data"] : node;
    std::vector<double> values;
    if (list && list.IsSequence())
      for (const YAML::Node& entry : list) values.push_back(number(entry, key));
    if (values.size() < least)
      throw InputError(
          fmt::format("{}: {} takes {} numbers or more, found {}", path_, key, least, values.size()));
    return values;
  }

  void set_size(double width, double height) {
    for (const double side : {width, height})
      if (side < 32 || side > 16384 || side != std::floor(side))
        throw InputError(
            fmt::format("{}: the image's sides are whole numbers of px from 32 to 16384", path_));
    camera_.width = static_cast<int>(width), camera_.height = static_cast<int>(height);
  }

  /// Where nothing tells the image's size, the default must at least have its middle near the principal
  /// point.
  void check_unsaid_size() const {
    if (std::abs(camera_.cx / camera_.width - 0.5) > 0.15 ||
        std::abs(camera_.cy / camera_.height - 0.5) > 0.15)
      throw InputError(fmt::format("{}: the image's width and height are missing", path_));
  }

  void read_orb_slam(const std::string& prefix) {
    if (const YAML::Node type = at("Camera.type"); type) {
      const std::string name = lower_case(type.as<std::string>(""));
      if (name != "pinhole" && name != "rectified" && name != "perspective")
        throw InputError(
            fmt::format("{}: Camera.type is {}, and only PinHole is read", path_, type.as<std::string>("")));
    }
    take(prefix + "fx", camera_.fx, true), take(prefix + "fy", camera_.fy, true);
    take(prefix + "cx", camera_.cx, true), take(prefix + "cy", camera_.cy, true);
    take(prefix + "k1", camera_.k1), take(prefix + "k2", camera_.k2), take(prefix + "k3", camera_.k3);
    take(prefix + "p1", camera_.p1), take(prefix + "p2", camera_.p2);
    const std::string width = has("Camera.width") ? "Camera.width" : "Camera.cols";
    const std::string height = has("Camera.height") ? "Camera.height" : "Camera.rows";
    if (has(width) && has(height))
      set_size(number(at(width), width), number(at(height), height));
    else
      check_unsaid_size();
    // ORB-SLAM has the baseline in px at one metre, or as it is. Files of depth cameras have one, too.
    double baseline_px = 0.0;
    take(has("Camera.bf") ? "Camera.bf" : "bf", baseline_px);
    camera_.baseline_m = std::max(0.0, baseline_px / camera_.fx);
    take("Stereo.b", camera_.baseline_m);
    for (const char* key :
         {"DepthMapFactor", "RGBD.DepthMapFactor", "depthmap_factor", "Preprocessing.depthmap_factor"})
      take(key, camera_.depth_scale);
  }

  /// EuRoC's file itself, or the first camera of a camchain.
  [[nodiscard]] YAML::Node first_camera() const {
    if (root_["intrinsics"]) return root_;
    for (const auto& entry : root_)
      if (entry.second.IsMap() && entry.second["intrinsics"]) return entry.second;
    return YAML::Node(YAML::NodeType::Undefined);
  }

  void read_intrinsics(const YAML::Node& node) {
    if (const YAML::Node model = node["camera_model"];
        model && lower_case(model.as<std::string>("")) != "pinhole")
      throw InputError(
          fmt::format("{}: camera_model is {}, and only pinhole is read", path_, model.as<std::string>("")));
    const auto intrinsics = numbers(node["intrinsics"], "intrinsics", 4);
    camera_.fx = intrinsics[0], camera_.fy = intrinsics[1], camera_.cx = intrinsics[2],
    camera_.cy = intrinsics[3];
    check_distortion_model(node);
    for (const char* key : {"distortion_coeffs", "distortion_coefficients"})
      if (node[key]) set_distortion(numbers(node[key], key, 0));
    if (node["resolution"]) {
      const auto size = numbers(node["resolution"], "resolution", 2);
      set_size(size[0], size[1]);
    } else {
      check_unsaid_size();
    }
  }

  void read_matrix() {
    const auto matrix = numbers(root_["camera_matrix"], "camera_matrix", 9);
    camera_.fx = matrix[0], camera_.cx = matrix[2], camera_.fy = matrix[4], camera_.cy = matrix[5];
    check_distortion_model(root_);
    if (root_["distortion_coefficients"])
      set_distortion(numbers(root_["distortion_coefficients"], "distortion_coefficients", 0));
    if (root_["image_width"] && root_["image_height"])
      set_size(number(root_["image_width"], "image_width"), number(root_["image_height"], "image_height"));
    else
      check_unsaid_size();
  }

  void check_distortion_model(const YAML::Node& node) const {
    const YAML::Node model = node["distortion_model"];
    if (!model) return;
    const std::string name = lower_case(model.as<std::string>(""));
    for (const char* known : {"radtan", "radial-tangential", "plumb_bob", "none", ""})
      if (name == known) return;
    throw InputError(fmt::format("{}: distortion_model is {}, and only radial-tangential distortion is read",
                                 path_, model.as<std::string>("")));
  }

  void set_distortion(const std::vector<double>& d) {
    double* const targets[] = {&camera_.k1, &camera_.k2, &camera_.p1, &camera_.p2, &camera_.k3};
    for (std::size_t i = 0; i < d.size(); ++i) {
      if (i < std::size(targets))
        *targets[i] = d[i];
      else if (d[i] != 0)
        throw InputError(fmt::format("{}: has {} distortion coefficients, and 5 are read", path_, d.size()));
    }
  }

  const std::string& path_;
  YAML::Node root_;
  Camera camera_;
};

}  // namespace

Camera read_yaml_camera(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw InputError(fmt::format("{}: the camera file cannot be read", path));
  std::stringstream text;
  text << file.rdbuf();
  return read_yaml_camera_text(path, text.str());
}

Camera read_yaml_camera_text(const std::string& path, std::string text) {
  try {
    return YamlReader(path, std::move(text)).read();
  } catch (const YAML::Exception& error) {
    throw InputError(
        fmt::format("{}:{}: not a readable camera file: {}", path, error.mark.line + 1, error.msg));
  }
}

Pose read_yaml_body_from_sensor(const std::string& path, std::string text) {
  try {
    return YamlReader(path, std::move(text)).body_from_sensor();
  } catch (const YAML::Exception& error) {
    throw InputError(
        fmt::format("{}:{}: not a readable camera file: {}", path, error.mark.line + 1, error.msg));
  }
}

}  // namespace stillpoint
