#include "core/sequence/stereo/stereo_input.hpp"

#include <fmt/format.h>

#include <set>
#include <utility>

#include "core/error.hpp"
#include "core/geometry/trajectory_file.hpp"
#include "core/sequence/stereo/stereo_recording.hpp"

namespace stillpoint {
namespace {

class StereoInput final : public SequenceInput {
 public:
  StereoInput(std::unique_ptr<FileStore> files, StereoRecording recording, const OpenOptions& options)
      : files_(std::move(files)), recording_(std::move(recording)), options_(options) {
    options_.progress = nullptr;  // of the opening alone
    for (const ListEntry& entry : recording_.lists.depths->entries) right_.insert(entry.file);
  }

  [[nodiscard]] std::string name() const override { return files_->own_names().front(); }
  [[nodiscard]] const std::string& place() const override { return files_->place(); }
  [[nodiscard]] FolderLists lists() override {
    FolderLists lists = recording_.lists;
    read_mask_list(*files_, lists);
    std::optional<StampUnit> known;
    if (recording_.stamped_in_ns && stamp_unit(lists.colours) == StampUnit::nanoseconds)
      known = StampUnit::nanoseconds;
    settle_stamps(lists, options_.frame_rate, known);
    return lists;
  }
  [[nodiscard]] FolderTruth truth(const std::vector<double>& stamps, StampUnit unit) override {
    if (recording_.truth.empty())
      return read_folder_truth(*files_, stamps, unit, options_.frame_rate, options_.truth);
    FolderTruth truth;
    truth.path = files_->path_of(recording_.truth);
    TrajectoryFile file;
    try {
      file = read_trajectory_text(truth.path, files_->read_text(recording_.truth));
    } catch (const InputError& error) {
      truth.why_not = error.what();
      return truth;
    }
    if (recording_.is_pose_a_row) {
      if (std::string why = stamp_rows(truth.path, file.poses, stamps); !why.empty()) {
        truth.why_not = std::move(why);
        return truth;
      }
      unit = StampUnit::seconds;
    }
    truth =
        settle_truth(truth.path, std::move(file.poses), stamps, unit, options_.frame_rate, options_.truth);
    for (StampedPose& pose : truth.poses)
      pose.world_from_camera = pose.world_from_camera * recording_.body_from_camera;
    truth.warnings.insert(truth.warnings.begin(), file.warnings.begin(), file.warnings.end());
    return truth;
  }
  [[nodiscard]] Camera camera(std::vector<std::string>&) override {
    if (!recording_.camera.is_stereo())
      throw InputError(
          fmt::format("{}: camera {} has no baseline_m, the distance (m) of the left camera from the "
                      "right one, without which a stereo pair has no scale",
                      place(), recording_.camera.name));
    return recording_.camera;
  }
  [[nodiscard]] ImageRead image(const std::string& file) const override {
    Bytes bytes;
    const std::string path = path_of(file), fault = files_->read(file, bytes);
    if (!fault.empty()) return {{}, path + " " + fault};
    ImageRead read = decode_image(path, std::move(bytes));
    if (recording_.rectification && !read.image.empty()) {
      const auto side = right_.contains(file) ? StereoRectification::kRight : StereoRectification::kLeft;
      read.image = recording_.rectification->rectified(read.image, side);
    }
    return read;
  }
  [[nodiscard]] std::string why_no_bytes(const std::string& file) const override {
    return files_->why_no_bytes(file);
  }
  [[nodiscard]] std::string path_of(const std::string& file) const override { return files_->path_of(file); }
  [[nodiscard]] std::vector<std::string> warnings() const override { return files_->warnings(); }

 private:
  /// Gives poses without stamps those of their rows. @returns why that cannot be; empty when all is well
  [[nodiscard]] std::string stamp_rows(const std::string& path, Trajectory& poses,
                                       const std::vector<double>& frames) const {
    // As many poses as frames are theirs, in order.
    const std::vector<double>& rows = poses.size() == frames.size() ? frames : recording_.row_stamps;
    for (StampedPose& pose : poses) {
      const auto row = static_cast<std::size_t>(pose.timestamp);
      if (row >= rows.size())
        return fmt::format("{}: has {} poses or more, and there are {} times for them", path, row + 1,
                           rows.size());
      pose.timestamp = rows[row];
    }
    return {};
  }

  std::unique_ptr<FileStore> files_;
  StereoRecording recording_;
  OpenOptions options_;
  std::set<std::string> right_;  // images of the right camera
};

}  // namespace

std::unique_ptr<SequenceInput> make_stereo_input(std::unique_ptr<FileStore>& files,
                                                 const OpenOptions& options) {
  auto recording = read_stereo_recording(*files, options);
  if (!recording) return nullptr;
  return std::make_unique<StereoInput>(std::move(files), std::move(*recording), options);
}

}  // namespace stillpoint
