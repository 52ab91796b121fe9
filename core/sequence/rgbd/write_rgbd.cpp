#include "core/sequence/rgbd/write_rgbd.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <set>
#include <sstream>

#include "core/error.hpp"
#include "core/media/image_codec.hpp"
#include "core/media/stored_depth.hpp"
#include "core/out_folder.hpp"
#include "core/sequence/association.hpp"
#include "core/sequence/generated/generated_sequence.hpp"
#include "core/sequence/rgbd/rgbd_recording.hpp"
#include "core/text_file.hpp"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;

void write_image(const fs::path& path, const cv::Mat& image) {
  // What is packed again must be the same; JPEG is lossy whatever its quality.
  constexpr int kQuality = 95;
  const std::vector<unsigned char> bytes =
      path.extension() == ".jpg" ? encode_jpeg(image, kQuality) : encode_camera_png(image);
  if (bytes.empty()) throw InputError(fmt::format("{} cannot be packed", path.string()));
  write_text_file(path, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

/// Whether a name is of a pattern with one `*` or none.
bool is_of(const std::string& name, const std::string& pattern) {
  const auto star = pattern.find('*');
  if (star == std::string::npos) return name == pattern;
  return name.size() >= pattern.size() - 1 && name.starts_with(pattern.substr(0, star)) &&
         name.ends_with(pattern.substr(star + 1));
}

std::set<fs::path> image_folders_of(const RgbdLayout& layout) {
  const RgbdNames names = layout.files.names(0, 0.0);
  return {fs::path(names.colour).parent_path(), fs::path(names.depth).parent_path()};
}

}  // namespace

std::optional<Pose> WrittenRgbd::pose(int index) const {
  return interpolate(source.ground_truth(), source.timestamp(index), kTruthMaxGap);
}

DepthCamera miniature_depth_camera() {
  DepthCamera depth;
  depth.camera.name = "depth";
  depth.camera.width = 320, depth.camera.height = 240;
  depth.camera.fx = 281.5, depth.camera.fy = 282.25, depth.camera.cx = 158.75, depth.camera.cy = 121.5;
  depth.colour_from_depth.linear() = so3_exp({0.004, -0.007, 0.003});
  depth.colour_from_depth.translation() = Eigen::Vector3d(0.025, 0.001, -0.002);
  return depth;
}

int write_rgbd_frame(const RgbdLayout& layout, const FrameSource& source, const Frame& frame,
                     const fs::path& folder) {
  const RgbdFiles& files = layout.files;
  const RgbdNames names = files.names(frame.index, frame.timestamp);
  if (frame.readable()) write_image(folder / names.colour, frame.colour.empty() ? frame.gray : frame.colour);
  cv::Mat depth = frame.depth;
  if (files.own_depth_camera) {
    const auto* const scene = dynamic_cast<const FilmedScene*>(&source);
    if (scene == nullptr)
      throw InputError(fmt::format(
          "{}: layout {} has a depth camera of its own, by which only a generated sequence is filmed",
          source.name(), layout.name));
    depth = scene->depth_seen_by(miniature_depth_camera(), frame.index);
  } else if (!frame.has_depth()) {
    return 0;
  }
  const StoredDepth stored = stored_depth(depth, files.units, files.none);
  write_image(folder / names.depth, stored.image);
  return stored.too_far;
}

void make_rgbd_folders(const RgbdLayout& layout, const fs::path& folder) {
  for (const fs::path& name : image_folders_of(layout)) fs::create_directories(folder / name);
}

std::vector<fs::path> rgbd_files_in(const fs::path& folder) {
  std::set<fs::path> found;
  for (const RgbdLayout* layout : rgbd_layouts()) {
    std::istringstream patterns(layout->files.own);
    for (std::string pattern; patterns >> pattern;) {
      const fs::path part = fs::path(pattern).parent_path();
      std::error_code none;
      for (const auto& entry : fs::directory_iterator(folder / part, none))
        if (entry.is_regular_file(none) && is_of((part / entry.path().filename()).string(), pattern))
          found.insert(entry.path());
    }
  }
  return {found.begin(), found.end()};
}

void remove_rgbd_folders(const fs::path& folder) {
  for (const RgbdLayout* layout : rgbd_layouts()) {
    std::istringstream patterns(layout->files.own);
    for (std::string pattern; patterns >> pattern;) {
      std::error_code ignored;  // others may have put something there
      if (const fs::path part = fs::path(pattern).parent_path(); !part.empty())
        fs::remove(folder / part, ignored);
    }
  }
}

void write_tum_texts(const WrittenRgbd& written, RgbdNames (*names)(int, double), const char* colour_list,
                     const char* depth_list) {
  std::string colours = "# timestamp filename\n", depths = colours;
  for (int i = 0; i < written.frames; ++i) {
    const RgbdNames image = names(i, written.source.timestamp(i));
    colours += fmt::format("{:.6f} {}\n", image.stamp, image.colour);
    if (fs::exists(written.folder / image.depth))
      depths += fmt::format("{:.6f} {}\n", image.stamp, image.depth);
  }
  write_text_file(written.folder / depth_list, depths);
  write_text_file(written.folder / colour_list, colours);
}

std::string matrix_text(const Eigen::Matrix4d& matrix) {
  std::string text;
  for (int i = 0; i < 16; ++i)
    text += fmt::format("{:.12g}{}", matrix(i / 4, i % 4), i % 4 == 3 ? "\n" : " ");
  return text;
}

Eigen::Matrix4d intrinsic_matrix(const Camera& camera) {
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  matrix(0, 0) = camera.fx, matrix(1, 1) = camera.fy, matrix(0, 2) = camera.cx, matrix(1, 2) = camera.cy;
  return matrix;
}

}  // namespace stillpoint
