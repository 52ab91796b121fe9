#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/sequence/list_file.hpp"
#include "core/sequence/source.hpp"

namespace stillpoint {

/// A folder in the TUM RGB-D layout: `rgb.txt` or `associations.txt` (which goes first), and, where they are,
/// `depth.txt`, `groundtruth.txt` (or ICL-NUIM's `*.gt.freiburg`), `mask.txt` and `camera.toml`. Bonn and
/// ICL-NUIM folders share it; stamps that are frame numbers are read as frames at 30 Hz.
///
/// Every colour image is a frame; depth and masks join it by greedy one-to-one association in time, as
/// `associations.txt` pairs them where that is given.
class TumFolder final : public FrameSource {
 public:
  /// @param camera overrides `camera.toml`, which overrides what the folder's or its parent's name says
  /// @throws InputError in one sentence when the folder, its lists or its ground truth cannot be used, or
  /// when not
  ///         one of its colour images can be read.
  explicit TumFolder(const std::string& folder, const std::optional<Camera>& camera = {});

  [[nodiscard]] const std::string& name() const override { return name_; }
  [[nodiscard]] const Camera& camera() const override { return camera_; }
  [[nodiscard]] int size() const override { return static_cast<int>(frames_.size()); }
  [[nodiscard]] double timestamp(int index) const override;
  [[nodiscard]] Frame read(int index) const override;
  [[nodiscard]] FrameTruth truth(int index) const override;
  [[nodiscard]] const Trajectory& ground_truth() const override { return ground_truth_; }
  [[nodiscard]] bool has_depth() const override { return has_depth_; }
  [[nodiscard]] bool has_masks() const override { return has_masks_; }
  [[nodiscard]] const std::vector<std::string>& warnings() const override { return warnings_; }

 private:
  struct Entry {
    ListEntry colour;
    std::optional<ListEntry> depth, mask;
  };

  void read_lists();
  void join_list(const std::string& list, std::optional<ListEntry> Entry::*part);
  void read_ground_truth();
  void settle_stamps();
  void choose_camera(const std::optional<Camera>& camera);
  void read_depth(const Entry& entry, Frame& frame) const;
  [[nodiscard]] std::string path_of(const std::string& file) const;
  [[nodiscard]] const Entry& entry(int index) const { return frames_.at(static_cast<std::size_t>(index)); }

  std::string folder_, name_, colour_list_;
  std::vector<Entry> frames_;
  Camera camera_;
  Trajectory ground_truth_;
  bool has_depth_ = false, has_masks_ = false;
  std::vector<std::string> warnings_;
};

}  // namespace stillpoint
