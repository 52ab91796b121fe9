#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/sequence/depth_registration.hpp"
#include "core/sequence/folder_lists.hpp"
#include "core/sequence/image_survey.hpp"
#include "core/sequence/sequence_input.hpp"
#include "core/sequence/source.hpp"
#include "core/sequence/stereo/stereo_matcher.hpp"

namespace stillpoint {

/// A recorded sequence: the images that an input names, a folder in the TUM RGB-D layout or near it, an
/// archive of one, a bag of messages, stereo pairs, or a video. What a folder may hold is said in
/// folder_lists.hpp, folder_truth.hpp and folder_camera.hpp, and what one of another layout may, in
/// rgbd/rgbd_recording.hpp; what a bag may, in bag/bag_input.hpp; what stereo may, in
/// stereo/stereo_recording.hpp.
///
/// Depth of a depth camera of its own is registered when a frame is read (depth_registration.hpp).
///
/// Every colour image is a frame; depth and masks join it by greedy one-to-one association in time, or as
/// `associations.txt` pairs them where that is given. Whatever can be known before the first frame is told
/// then, in warnings() and why_not(): a few images of each kind are looked at on opening.
class ListedSequence final : public FrameSource {
 public:
  /// @param options camera, frame_rate, depth_scale, truth, inverted_masks, depth_offset_s and
  /// stereo are used
  /// @throws InputError in one sentence when its lists or its camera cannot be used, or when
  /// not one of
  ///         its colour images can be read.
  explicit ListedSequence(std::unique_ptr<SequenceInput> input, const OpenOptions& options = {});

  [[nodiscard]] const std::string& name() const override { return name_; }
  [[nodiscard]] const Camera& camera() const override { return camera_; }
  [[nodiscard]] int size() const override { return static_cast<int>(frames_.size()); }
  [[nodiscard]] double timestamp(int index) const override;
  [[nodiscard]] Frame read(int index) const override;
  [[nodiscard]] FrameTruth truth(int index) const override;
  [[nodiscard]] const Trajectory& ground_truth() const override { return ground_truth_; }
  [[nodiscard]] bool has_depth() const override { return has_depth_; }
  [[nodiscard]] bool has_masks() const override { return has_masks_; }
  [[nodiscard]] std::string why_not(FramePart part) const override;
  [[nodiscard]] std::optional<double> depth_late_s() const override { return depth_late_s_; }
  [[nodiscard]] const std::vector<std::string>& warnings() const override { return warnings_; }
  [[nodiscard]] std::vector<std::string> contents() const override { return input_->contents(); }

 private:
  struct Entry {
    ListEntry colour;
    std::optional<ListEntry> depth, mask;  // depth: of a stereo pair, the right image
  };
  using Part = std::optional<ListEntry> Entry::*;

  void read_lists();
  void join_depth(FolderLists& lists);
  void join_right(const FolderLists& lists);
  /// Tells right images that were not taken with their left ones.
  void question_exposures();
  void join_masks(const ImageList& masks);
  /// Files that are missing or empty, by their names: what reading them would tell frame by frame.
  void tell_files_without_bytes();
  int join(const ImageList& list, Part part);
  [[nodiscard]] cv::Size choose_camera();
  void begin_registration();
  void begin_stereo();
  void survey_stereo();
  void survey_depth_images();
  /// What depth images must be of.
  [[nodiscard]] DepthSize depth_size() const;
  void question_scale(const DepthSurvey& survey);
  void survey_mask_images(cv::Size colour);
  void question_convention();
  [[nodiscard]] ImagePaths sample(Part part, std::size_t count) const;
  void read_depth(const Entry& entry, Frame& frame) const;
  void register_depth(const std::string& path, Frame& frame) const;
  void read_right(const Entry& entry, Frame& frame) const;
  [[nodiscard]] ImageReader reader() const;
  [[nodiscard]] std::string path_of(const std::string& file) const { return input_->path_of(file); }
  [[nodiscard]] const Entry& entry(int index) const { return frames_.at(static_cast<std::size_t>(index)); }
  [[nodiscard]] std::vector<double> stamps() const;

  std::unique_ptr<SequenceInput> input_;
  std::string folder_, name_, colour_list_, depth_list_, mask_list_;
  OpenOptions options_;
  std::vector<Entry> frames_;
  std::optional<double> depth_late_s_;
  StampUnit unit_ = StampUnit::seconds;
  Camera camera_;
  Trajectory ground_truth_;
  bool is_stereo_ = false, has_depth_ = false, has_masks_ = false;
  std::optional<StereoMatcher> matcher_;           // of stereo pairs
  std::optional<DepthRegistration> registration_;  // of depth images that are not registered
  MaskCoding mask_coding_ = MaskCoding::bright;
  std::map<FramePart, std::string> why_not_;
  std::vector<std::string> warnings_;
};

}  // namespace stillpoint
