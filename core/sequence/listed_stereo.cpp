// What a sequence of stereo pairs has of its own: right images in the place of depth images.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/error.hpp"
#include "core/sequence/association.hpp"
#include "core/sequence/listed_sequence.hpp"
#include "core/sequence/stereo/pair_survey.hpp"

namespace stillpoint {
namespace {

constexpr std::size_t kPairSample = 5;  // pairs looked at on opening

}  // namespace

void ListedSequence::join_right(const FolderLists& lists) {
  depth_list_ = lists.depths->path;
  has_depth_ = true;
  const std::size_t right = lists.depths->entries.size(), left = frames_.size();
  const auto joined = static_cast<std::size_t>(join(*lists.depths, &Entry::depth));
  if (joined == 0)
    throw InputError(fmt::format("{}: none of its {} images belongs to one of the {} of {}", depth_list_,
                                 right, left, colour_list_));
  if (joined < left || joined < right)
    warnings_.push_back(
        fmt::format("{}: has {} images where {} has {}; {} pairs were found, and frames without a "
                    "right image have no depth",
                    depth_list_, right, colour_list_, left, joined));
  question_exposures();
}

void ListedSequence::question_exposures() {
  constexpr double kAtOnce = 0.001;  // s: a camera that turns by 1 rad/s moves half a pixel in it
  std::vector<double> late;
  for (const Entry& frame : frames_)
    if (frame.depth) late.push_back(frame.depth->timestamp - frame.colour.timestamp);
  if (late.empty()) return;
  const auto middle = late.begin() + static_cast<std::ptrdiff_t>(late.size() / 2);
  std::nth_element(late.begin(), middle, late.end());
  if (std::abs(*middle) <= kAtOnce) return;
  warnings_.push_back(fmt::format(
      "{}: its images were taken {:.1f} ms {} than those of {}, in the median: what camera and "
      "things move in between is taken for depth",
      depth_list_, 1000.0 * std::abs(*middle), *middle > 0.0 ? "later" : "earlier", colour_list_));
}

void ListedSequence::begin_stereo() {
  matcher_.emplace(camera_, options_.stereo);
  camera_ = matcher_->camera();
}

void ListedSequence::survey_stereo() {
  std::vector<PairPaths> pairs;
  std::vector<const Entry*> joined;
  for (const Entry& frame : frames_)
    if (frame.depth) joined.push_back(&frame);
  const std::size_t count = std::min(kPairSample, joined.size());
  for (std::size_t i = 0; i < count; ++i) {
    const Entry& frame = *joined[count < 2 ? 0 : i * (joined.size() - 1) / (count - 1)];
    pairs.push_back({frame.colour.file, frame.depth->file});
  }
  const PairSurvey survey = survey_pairs(pairs, reader());
  const auto refuse = [this](std::string why) {
    has_depth_ = false;
    why_not_[FramePart::depth] = std::move(why);
  };
  if (survey.fit == 0 && survey.pairs > 0)
    refuse(fmt::format("{}: {}", depth_list_, survey.fault));
  else if (is_exchanged(survey))
    refuse(fmt::format(
        "{}: {:.0f} % of {} matched corners lie farther right than in {}, which nothing before two "
        "cameras does: left and right are exchanged",
        depth_list_, 100.0 * survey.to_the_left, survey.matches, colour_list_));
  else if (is_unrectified(survey))
    warnings_.push_back(
        fmt::format("{}: matched corners lie {:.1f} px {} than in {}, give or take {:.1f} px: the "
                    "pair is not rectified, and its depth is of little use",
                    depth_list_, std::abs(survey.row_offset_px),
                    survey.row_offset_px < 0.0 ? "higher" : "lower", colour_list_, survey.row_spread_px));
}

void ListedSequence::read_right(const Entry& listed, Frame& frame) const {
  if (!listed.depth) {
    frame.problem = "has no right image";
    return;
  }
  const ImageRead right = input_->image(listed.depth->file);
  if (right.image.empty())
    frame.problem = right.problem;
  else if (right.image.size() != frame.gray.size())
    frame.problem = fmt::format("{} is {}x{} px, but its left image is {}x{} px", path_of(listed.depth->file),
                                right.image.cols, right.image.rows, frame.gray.cols, frame.gray.rows);
  else
    matcher_->match(frame, to_8bit(right.image));
}

}  // namespace stillpoint
