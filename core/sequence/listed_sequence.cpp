#include "core/sequence/listed_sequence.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>

#include "core/counted.hpp"
#include "core/error.hpp"
#include "core/media/stored_depth.hpp"
#include "core/median.hpp"
#include "core/sequence/association.hpp"
#include "core/sequence/folder_camera.hpp"
#include "core/sequence/image_file.hpp"
#include "core/text_file.hpp"

namespace stillpoint {
namespace {

constexpr double kFewestJoined = 0.7;  // of the colour images with depth; fewer are told
constexpr double kMostJoined = 0.9;  // of the depth images with colour; with more, depth's clock is colour's
constexpr std::size_t kDepthSample = 5, kMaskSample = 8;  // images looked at on opening
constexpr double kMostMoving = 0.7;                       // of the masks' pixels; more look inverted

/// The median step of increasing stamps, s.
double usual_interval(const std::vector<double>& stamps) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < stamps.size(); ++i) steps.push_back(stamps[i] - stamps[i - 1]);
  return median_of(steps);
}

}  // namespace

ListedSequence::ListedSequence(std::unique_ptr<SequenceInput> input, const OpenOptions& options)
    : input_(std::move(input)), folder_(input_->place()), name_(input_->name()), options_(options) {
  options_.progress = nullptr;  // of the opening alone
  read_lists();
  FolderTruth truth = input_->truth(stamps(), unit_);
  ground_truth_ = std::move(truth.poses);
  if (!truth.why_not.empty()) why_not_[FramePart::truth] = truth.why_not;
  warnings_.insert(warnings_.end(), truth.warnings.begin(), truth.warnings.end());
  const cv::Size size = choose_camera();
  begin_registration();
  if (is_stereo_) {
    begin_stereo();
    survey_stereo();
  } else if (has_depth_) {
    survey_depth_images();
  }
  if (has_masks_) survey_mask_images(size);
  question_convention();
  for (const auto& [part, sentence] : why_not_) warnings_.push_back(sentence);
  for (std::string& sentence : warnings_) sentence = printable(std::move(sentence));
}

ImageReader ListedSequence::reader() const {
  return [this](const std::string& file) { return input_->image(file); };
}

std::string ListedSequence::why_not(FramePart part) const {
  const auto known = why_not_.find(part);
  return known == why_not_.end() ? std::string() : known->second;
}

std::vector<double> ListedSequence::stamps() const {
  std::vector<double> all;
  all.reserve(frames_.size());
  for (const Entry& frame : frames_) all.push_back(frame.colour.timestamp);
  return all;
}

void ListedSequence::read_lists() {
  FolderLists lists = input_->lists();
  warnings_ = input_->warnings();
  warnings_.insert(warnings_.end(), lists.warnings.begin(), lists.warnings.end());
  colour_list_ = lists.colours.path;
  unit_ = lists.unit;
  for (ListEntry& colour : lists.colours.entries) frames_.push_back({std::move(colour), {}, {}});
  is_stereo_ = lists.stereo;
  if (is_stereo_)
    join_right(lists);
  else if (lists.depths)
    join_depth(lists);
  else if (!lists.why_no_depth.empty())
    why_not_[FramePart::depth] = lists.why_no_depth;
  if (lists.masks) join_masks(*lists.masks);
  tell_files_without_bytes();
}

void ListedSequence::join_depth(FolderLists& lists) {
  depth_list_ = lists.depths->path;
  for (ListEntry& depth : lists.depths->entries) depth.timestamp += options_.depth_offset_s;
  has_depth_ = true;
  if (lists.paired) {
    for (std::size_t i = 0; i < frames_.size(); ++i) frames_[i].depth = std::move(lists.depths->entries[i]);
    const auto far = std::find_if(frames_.begin(), frames_.end(), [](const Entry& e) {
      return std::abs(e.colour.timestamp - e.depth->timestamp) >= kAssociationTolerance;
    });
    if (far != frames_.end()) {
      depth_late_s_ = far->depth->timestamp - far->colour.timestamp;
      warnings_.push_back(fmt::format("{}:{}: pairs images {:.3f} s apart; it was taken at its word",
                                      depth_list_, far->colour.line, std::abs(*depth_late_s_)));
    }
    return;
  }
  const std::size_t listed = lists.depths->entries.size();
  const double later = lists.depths->entries.front().timestamp - frames_.front().colour.timestamp;
  const int joined = join(*lists.depths, &Entry::depth);
  const std::string begins = fmt::format("the first depth image is {:.3f} s {} than the first colour image",
                                         std::abs(later), later > 0 ? "later" : "earlier");
  if (joined == 0) {
    has_depth_ = false;
    why_not_[FramePart::depth] = fmt::format(
        "{}: none of its {} stamps is within {} s of a colour image's: {} (`--depth-offset {:.6f}` lays "
        "first on "
        "first)",
        depth_list_, listed, kAssociationTolerance, begins, options_.depth_offset_s - later);
  } else if (joined < kFewestJoined * static_cast<double>(frames_.size())) {
    const std::string without =
        fmt::format("{}: {} of {} colour images have no depth image within {} s", depth_list_,
                    frames_.size() - static_cast<std::size_t>(joined), frames_.size(), kAssociationTolerance);
    // Depth that finds its colour is of the right time: there is less of it.
    if (joined > kMostJoined * static_cast<double>(listed)) {
      std::vector<double> depth_stamps;
      for (const ListEntry& depth : lists.depths->entries) depth_stamps.push_back(depth.timestamp);
      warnings_.push_back(
          listed < 2 ? fmt::format("{}: there is only {}", without, counted(listed, "depth image"))
                     : fmt::format("{}: there are only {}, one every {:.3f} s where colour images come every "
                                   "{:.3f} s",
                                   without, counted(listed, "depth image"), usual_interval(depth_stamps),
                                   usual_interval(stamps())));
      return;
    }
    if (std::abs(later) < kAssociationTolerance) {
      warnings_.push_back(without);
      return;
    }
    // Who gave an offset settled the clock.
    if (options_.depth_offset_s == 0) depth_late_s_ = later;
    warnings_.push_back(fmt::format("{}; {} (if its clock is, `--depth-offset {:.6f}` mends that)", without,
                                    begins, options_.depth_offset_s - later));
  }
}

void ListedSequence::join_masks(const ImageList& masks) {
  mask_list_ = masks.path;
  has_masks_ = true;
  if (join(masks, &Entry::mask) == 0) {
    has_masks_ = false;
    why_not_[FramePart::masks] = fmt::format("{}: none of its stamps is within {} s of a colour image's",
                                             mask_list_, kAssociationTolerance);
    return;
  }
}

void ListedSequence::tell_files_without_bytes() {
  constexpr std::size_t kMostNamed = 6;  // files: a hint, and no listing
  const auto tell = [this](const std::string& list, const char* images, const char* so, const auto& file_of) {
    std::vector<std::string> told;
    std::size_t listed = 0, without = 0;
    for (const Entry& frame : frames_) {
      const ListEntry* file = file_of(frame);
      if (file == nullptr) continue;
      ++listed;
      const std::string why = input_->why_no_bytes(file->file);
      if (why.empty()) continue;
      if (++without <= kMostNamed) told.push_back(fmt::format("{} {}", file->file, why));
    }
    if (without == 0) return;
    if (without > kMostNamed) told.push_back(fmt::format("and {} more", without - kMostNamed));
    warnings_.push_back(fmt::format("{}: {} of {} {} are missing or empty, and {}: {}", list, without, listed,
                                    images, so, fmt::join(told, ", ")));
  };
  tell(colour_list_, "colour images", "their frames cannot be read",
       [](const Entry& e) { return &e.colour; });
  if (has_depth_ || is_stereo_)
    tell(depth_list_, is_stereo_ ? "right images" : "depth images", "their frames have no depth",
         [](const Entry& e) { return e.depth ? &*e.depth : nullptr; });
  if (has_masks_)
    tell(mask_list_, "masks", "their frames have no true mask",
         [](const Entry& e) { return e.mask ? &*e.mask : nullptr; });
}

int ListedSequence::join(const ImageList& list, Part part) {
  std::vector<double> listed;
  for (const ListEntry& image : list.entries) listed.push_back(image.timestamp);
  const auto pairs = associate(stamps(), listed);
  for (const AssociatedPair& pair : pairs) frames_[pair.first].*part = list.entries[pair.second];
  return static_cast<int>(pairs.size());
}

cv::Size ListedSequence::choose_camera() {
  camera_ = input_->camera(warnings_);
  // A camera file may have a baseline though depth is a sensor's own.
  if (!is_stereo_) camera_.baseline_m = camera_.depth_sigma_per_m2 = 0.0;
  if (options_.depth_scale) camera_.depth_scale = *options_.depth_scale;
  std::string first_problem;
  for (const Entry& frame : frames_) {
    const ImageRead image = input_->image(frame.colour.file);
    if (image.image.empty()) {
      if (first_problem.empty()) first_problem = fmt::format("line {}: {}", frame.colour.line, image.problem);
      continue;
    }
    camera_ = camera_for_size(camera_, image.image.size(), folder_, warnings_);
    return image.image.size();
  }
  throw InputError(
      fmt::format("{}: none of its {} images can be read; {}", colour_list_, frames_.size(), first_problem));
}

ImagePaths ListedSequence::sample(Part part, std::size_t count) const {
  std::vector<const ListEntry*> listed;
  for (const Entry& frame : frames_)
    if (frame.*part) listed.push_back(&*(frame.*part));
  ImagePaths paths;
  for (std::size_t i = 0; i < std::min(count, listed.size()); ++i) {
    const std::size_t at = listed.size() <= count ? i : i * (listed.size() - 1) / (count - 1);
    paths.push_back(listed[at]->file);
  }
  return paths;
}

void ListedSequence::begin_registration() {
  if (!has_depth_ || is_stereo_) camera_.depth_camera.reset();
  if (camera_.depth_camera) registration_.emplace(*camera_.depth_camera, camera_);
}

DepthSize ListedSequence::depth_size() const {
  if (registration_) return {registration_->depth_size(), "the depth camera is of"};
  return {cv::Size(camera_.width, camera_.height), "its colour image is"};
}

void ListedSequence::survey_depth_images() {
  const DepthSurvey survey = survey_depth(sample(&Entry::depth, kDepthSample), depth_size(), reader());
  if (survey.fit == 0 && survey.read > 0) {
    has_depth_ = false;
    why_not_[FramePart::depth] =
        survey.fault + (survey.other_size && !registration_
                            ? "; a [depth_camera] in camera.toml registers depth of another camera"
                            : "");
    return;
  }
  question_scale(survey);
}

void ListedSequence::question_scale(const DepthSurvey& survey) {
  const auto doubt = doubt_scale(survey, survey.in_metres ? kMetresSurveyScale : camera_.depth_scale);
  if (!doubt) return;
  if (survey.in_metres) {
    warnings_.push_back(fmt::format(
        "{}: depth in metres reads {:.2f} to {:.2f} m, {:.2f} m in the middle, which is no range of "
        "a depth camera (`--depth-scale 1000` takes it for millimetres)",
        depth_list_, doubt->nearest_m, doubt->farthest_m, doubt->median_m));
    return;
  }
  std::string sentence = fmt::format(
      "{}: at {:g} units a metre (camera {}) depth reads {:.2f} to {:.2f} m, {:.2f} m in the middle, which "
      "is no range of a depth "
      "camera",
      depth_list_, camera_.depth_scale, camera_.name, doubt->nearest_m, doubt->farthest_m, doubt->median_m);
  if (doubt->likely_scale) {
    const double ratio = camera_.depth_scale / *doubt->likely_scale;
    sentence += fmt::format("; at {:g}{} it would be {:.2f} to {:.2f} m: `--depth-scale {:g}` reads it so",
                            *doubt->likely_scale, *doubt->likely_scale == 1000 ? " (millimetres)" : "",
                            doubt->nearest_m * ratio, doubt->farthest_m * ratio, *doubt->likely_scale);
  }
  warnings_.push_back(sentence);
}

void ListedSequence::survey_mask_images(cv::Size colour) {
  const MaskSurvey survey = survey_masks(sample(&Entry::mask, kMaskSample), reader());
  if (survey.read == 0) return;
  mask_coding_ = survey.coding;
  if (survey.size != colour) {
    has_masks_ = false;
    why_not_[FramePart::masks] =
        fmt::format("{}: the masks are {}x{} px, but the colour images are {}x{} px; none is used",
                    mask_list_, survey.size.width, survey.size.height, colour.width, colour.height);
    return;
  }
  if (const std::string how = how_read(survey, "read as moving"); !how.empty())
    warnings_.push_back(fmt::format("{}: {}", mask_list_, how));
  const double moving = options_.inverted_masks ? 1.0 - survey.moving_share : survey.moving_share;
  if (moving > kMostMoving)
    warnings_.push_back(fmt::format(
        "{}: {:.0f} % of the masks' pixels are said to move; if white is what is static, {} reads them so",
        mask_list_, 100.0 * moving,
        options_.inverted_masks ? "leaving out `--invert-masks`" : "`--invert-masks`"));
}

void ListedSequence::question_convention() {
  if (camera_.name == "bonn" && !ground_truth_.empty() && options_.truth == PoseConvention::as_written)
    warnings_.push_back(
        fmt::format("{}: Bonn's ground truth is the pose of a marker body, turned some 173 deg from the "
                    "camera; relative errors "
                    "mean nothing without `--truth bonn`, which reads it as the camera's",
                    folder_));
}

double ListedSequence::timestamp(int index) const {
  return entry(index).colour.timestamp + camera_.stamp_delay_s;
}

Frame ListedSequence::read(int index) const {
  const Entry& listed = entry(index);
  Frame frame;
  frame.index = index;
  frame.name = std::filesystem::path(listed.colour.file).stem().string();
  frame.timestamp = timestamp(index);
  const ImageRead image = input_->image(listed.colour.file);
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
  if (has_depth_) is_stereo_ ? read_right(listed, frame) : read_depth(listed, frame);
  return frame;
}

namespace {

/// Whether a depth image that is not all zero has a reading.
bool holds_measurement(const ImageRead& depth) {
  // Most images tell by their first rows, and are looked at no further.
  for (int row = 0; row < depth.image.rows; ++row) {
    const cv::Mat values = depth.image.row(row);
    const cv::Mat measured = depth.in_metres ? cv::Mat(values > 0) : cv::Mat((values > 0) & (values < 65535));
    if (cv::countNonZero(measured) > 0) return true;
  }
  return false;
}

}  // namespace

void ListedSequence::read_depth(const Entry& listed, Frame& frame) const {
  if (!listed.depth) {
    frame.problem = fmt::format("no depth image within {} s", kAssociationTolerance);
    return;
  }
  const std::string path = path_of(listed.depth->file);
  ImageRead depth = input_->image(listed.depth->file);
  if (depth.image.empty())
    frame.problem = depth.problem;
  else if (std::string fault = fault_of_depth(path, depth, depth_size()); !fault.empty())
    frame.problem = std::move(fault);
  else if (cv::countNonZero(depth.image) == 0)
    frame.problem = fmt::format("{} is zero everywhere: no depth was measured", path);
  else if (!holds_measurement(depth))
    frame.problem = fmt::format("{} holds no depth above zero{}: none was measured", path,
                                depth.in_metres ? "" : " but 65535");
  else {
    frame.depth = depth.image;
    if (!depth.in_metres) frame.depth = metres_of(depth.image, camera_.depth_scale);
    if (registration_) register_depth(path, frame);
    frame.depth_timestamp = listed.depth->timestamp;
  }
}

void ListedSequence::register_depth(const std::string& path, Frame& frame) const {
  frame.depth = registration_->registered(frame.depth);
  if (cv::countNonZero(frame.depth) > 0) return;
  frame.depth.release();
  frame.problem = fmt::format("{}: the colour camera sees nothing of its depth", path);
}

FrameTruth ListedSequence::truth(int index) const {
  const Entry& listed = entry(index);
  FrameTruth truth;
  truth.world_from_camera = interpolate(ground_truth_, timestamp(index), kTruthMaxGap);
  if (!truth.world_from_camera)
    if (const auto near = nearest_pose(ground_truth_, timestamp(index), kAssociationTolerance))
      truth.world_from_camera = ground_truth_[*near].world_from_camera;
  if (listed.mask && has_masks_) {
    const ImageRead mask = input_->image(listed.mask->file);
    if (!mask.image.empty() && mask.image.cols == camera_.width && mask.image.rows == camera_.height) {
      truth.moving = moving_pixels(mask.image, mask_coding_);
      if (options_.inverted_masks) truth.moving = truth.moving == 0;
    }
  }
  return truth;
}

}  // namespace stillpoint
