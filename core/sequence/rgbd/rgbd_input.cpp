#include "core/sequence/rgbd/rgbd_input.hpp"

#include <cmath>
#include <utility>

#include "core/sequence/folder_camera.hpp"
#include "core/sequence/rgbd/rgbd_recording.hpp"

namespace stillpoint {
namespace {

class RgbdInput final : public SequenceInput {
 public:
  RgbdInput(std::unique_ptr<FileStore> files, RgbdRecording recording, const OpenOptions& options)
      : files_(std::move(files)), recording_(std::move(recording)), options_(options) {
    options_.progress = nullptr;  // of the opening alone
  }

  [[nodiscard]] std::string name() const override { return files_->own_names().front(); }
  [[nodiscard]] const std::string& place() const override { return files_->place(); }
  [[nodiscard]] FolderLists lists() override {
    if (!recording_.lists) return read_folder_lists(*files_, options_.frame_rate);
    FolderLists lists = *recording_.lists;
    read_mask_list(*files_, lists);
    settle_stamps(lists, options_.frame_rate, recording_.unit);
    return lists;
  }
  [[nodiscard]] FolderTruth truth(const std::vector<double>& stamps, StampUnit unit) override {
    if (!recording_.no_truth.empty()) {
      FolderTruth none;
      none.why_not = recording_.no_truth;
      return none;
    }
    FolderTruth truth = recording_.truth
                            ? poses_of_images(stamps, unit)
                            : read_folder_truth(*files_, stamps, unit, options_.frame_rate, options_.truth);
    for (StampedPose& pose : truth.poses)
      pose.world_from_camera = pose.world_from_camera * recording_.body_from_camera;
    return truth;
  }
  [[nodiscard]] Camera camera(std::vector<std::string>& warnings) override {
    return recording_.camera ? *recording_.camera : camera_of_folder(*files_, options_.camera, warnings);
  }
  [[nodiscard]] ImageRead image(const std::string& file) const override {
    Bytes bytes;
    const std::string path = path_of(file), fault = files_->read(file, bytes);
    return fault.empty() ? decode_image(path, std::move(bytes)) : ImageRead{{}, path + " " + fault};
  }
  [[nodiscard]] std::string why_no_bytes(const std::string& file) const override {
    return files_->why_no_bytes(file);
  }
  [[nodiscard]] std::string path_of(const std::string& file) const override { return files_->path_of(file); }
  [[nodiscard]] std::vector<std::string> warnings() const override { return files_->warnings(); }

 private:
  /// Poses that belong to images, at their images' stamps.
  [[nodiscard]] FolderTruth poses_of_images(const std::vector<double>& stamps, StampUnit unit) const {
    const FolderTruth& read = *recording_.truth;
    if (read.poses.empty()) return read;
    Trajectory poses = read.poses;
    for (StampedPose& pose : poses) pose.timestamp *= seconds_per(unit, options_.frame_rate);
    FolderTruth truth = settle_truth(read.path, std::move(poses), stamps, StampUnit::seconds,
                                     options_.frame_rate, options_.truth);
    truth.warnings.insert(truth.warnings.begin(), read.warnings.begin(), read.warnings.end());
    return truth;
  }

  std::unique_ptr<FileStore> files_;
  RgbdRecording recording_;
  OpenOptions options_;
};

}  // namespace

std::unique_ptr<SequenceInput> make_rgbd_input(std::unique_ptr<FileStore>& files,
                                               const OpenOptions& options) {
  auto recording = read_rgbd_recording(*files, options);
  if (!recording) return nullptr;
  return std::make_unique<RgbdInput>(std::move(files), std::move(*recording), options);
}

}  // namespace stillpoint
