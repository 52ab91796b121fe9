// Archives: their index and files; and folders of every layout, as archives hold them.
#include <fmt/format.h>

#include <filesystem>

#include "core/error.hpp"
#include "core/media/image_codec.hpp"
#include "core/out_folder.hpp"
#include "core/sequence/archive/archive_index.hpp"
#include "core/sequence/archive/archive_store.hpp"
#include "core/sequence/listed_sequence.hpp"
#include "core/sequence/rgbd/rgbd_recording.hpp"
#include "core/sequence/write_sequence.hpp"
#include "tests/fuzz/targets.hpp"
#include "tests/support/archive_writer.hpp"

namespace stillpoint::fuzz {
namespace {

namespace fs = std::filesystem;
using Seeds = std::vector<std::string>;

/// Two frames of 40x32 px, RGB-D or a stereo pair.
class TinySequence final : public FrameSource {
 public:
  explicit TinySequence(bool is_stereo) {
    camera_.name = "camera", camera_.width = 40, camera_.height = 32;
    camera_.fx = camera_.fy = 40, camera_.cx = 20, camera_.cy = 16;
    if (is_stereo) camera_.baseline_m = 0.1;
    for (int i = 0; i < size(); ++i) truth_.push_back({timestamp(i), Pose::Identity()});
  }

  [[nodiscard]] const std::string& name() const override { return camera_.name; }
  [[nodiscard]] const Camera& camera() const override { return camera_; }
  [[nodiscard]] int size() const override { return 2; }
  [[nodiscard]] double timestamp(int index) const override { return 1.0 + index / 30.0; }
  [[nodiscard]] Frame read(int index) const override {
    const cv::Size size(camera_.width, camera_.height);
    Frame frame;
    frame.index = index, frame.timestamp = frame.depth_timestamp = timestamp(index);
    frame.colour = cv::Mat(size, CV_8UC3, cv::Scalar::all(90));
    frame.gray = cv::Mat(size, CV_8UC1, cv::Scalar::all(90));
    frame.depth = cv::Mat(size, CV_32FC1, cv::Scalar(2.0));
    if (camera_.is_stereo()) {
      const StereoView pair{frame.gray, cv::Mat::zeros(size, CV_8UC1), 0.0};
      frame.stereo = std::make_shared<const StereoView>(pair);
    }
    return frame;
  }
  [[nodiscard]] FrameTruth truth(int index) const override {
    return {truth_[static_cast<std::size_t>(index)].world_from_camera, {}, {}};
  }
  [[nodiscard]] const Trajectory& ground_truth() const override { return truth_; }
  [[nodiscard]] bool has_depth() const override { return true; }
  [[nodiscard]] bool has_masks() const override { return false; }
  [[nodiscard]] const std::vector<std::string>& warnings() const override { return warnings_; }

 private:
  Camera camera_;
  Trajectory truth_;
  std::vector<std::string> warnings_;
};

/// A folder's bytes as an archive; the folder goes away.
std::string pack(const fs::path& folder, const std::string& kind) {
  std::string bytes = written("a." + kind, [&](const std::string& path) {
    write_archive(path, folder.string(), kind == "tar" ? "gnutar" : "zip", "street");
  });
  fs::remove_all(folder);
  return bytes;
}

/// A sequence in some layout, packed.
std::string packed(const WriteOptions& options, bool is_stereo, const std::string& kind) {
  const fs::path folder = fs::path(work_folder()) / "written";
  write_sequence(TinySequence(is_stereo), folder, options);
  return pack(folder, kind);
}

/// ScanNet's layout, whose depth camera only a rendered sequence has.
std::string packed_scannet() {
  const fs::path folder = fs::path(work_folder()) / "written";
  const auto matrix = [&](const char* name, double focal) {
    write_text_file(folder / name, fmt::format("{0} 0 20 0\n0 {0} 16 0\n0 0 1 0\n0 0 0 1\n", focal));
  };
  for (const char* name : {"color", "depth", "intrinsic", "pose"}) fs::create_directories(folder / name);
  (void)save_image(folder / "color/0.jpg", cv::Mat(32, 40, CV_8UC3, cv::Scalar::all(90)));
  (void)save_image(folder / "depth/0.png", cv::Mat(32, 40, CV_16UC1, cv::Scalar::all(2000)));
  matrix("intrinsic/intrinsic_color.txt", 40);
  matrix("intrinsic/intrinsic_depth.txt", 42);
  write_text_file(folder / "pose/0.txt", "1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n");
  return pack(folder, "tar");
}

/// The files of an archive: few of them are read, for many may share their bytes.
void read_files(const FileStore& files, const std::string& folder, int& left) {
  for (const std::string& name : files.entries(folder)) {
    const std::string whole = folder.empty() ? name : folder + "/" + name;
    if (left-- <= 0) return;
    Bytes bytes;
    if (files.is_file(whole)) (void)files.read(whole, bytes);
    if (files.is_folder(whole)) read_files(files, whole, left);
  }
}

void read_archive(const std::string& path) {
  int left = 20;
  read_files(*open_archive(path, path), "", left);
}

void read_tar(std::string_view bytes) { read_archive(file_of(bytes, "a.tar")); }
Seeds tar_seeds() { return {packed({}, false, "tar")}; }

void read_zip(std::string_view bytes) { read_archive(file_of(bytes, "a.zip")); }
Seeds zip_seeds() { return {packed({}, false, "zip")}; }

void read_layout(std::string_view bytes) {
  const std::string path = file_of(bytes, "a.tar");
  const OpenOptions options;
  const ListedSequence sequence(make_folder_input(open_archive(path, path), options), options);
  (void)sequence.read(0);
}
Seeds layout_seeds() {
  Seeds seeds = {packed({}, false, "tar"), packed_scannet()};
  for (const RgbdLayout* layout : rgbd_layouts())
    if (!layout->files.own_depth_camera) seeds.push_back(packed({.rgbd = layout}, false, "tar"));
  for (const auto layout : {SequenceLayout::left_right, SequenceLayout::kitti, SequenceLayout::euroc})
    seeds.push_back(packed({.layout = layout}, true, "tar"));
  return seeds;
}

}  // namespace

std::vector<Target> archive_targets() {
  // Deflate packs a thousandfold at most; a layout's images are decoded, and its camera's tables made.
  return {{"tar", {256 << 10, 100}, read_tar, tar_seeds},
          {"zip", {256 << 10, 1200}, read_zip, zip_seeds},
          {"layout", {4 << 20, 8000}, read_layout, layout_seeds}};
}

}  // namespace stillpoint::fuzz
