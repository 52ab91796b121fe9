#include "core/run/record_codec.hpp"

#include <algorithm>
#include <cstring>
#include <span>

#include "core/run/frame_scores.hpp"

namespace stillpoint {
namespace {

// Each list of fields serves writing and reading alike, so that the two cannot part.

template <typename Archive, typename PoseType>
void transfer_pose(Archive& archive, PoseType& pose) {
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 3; ++row) archive(pose.matrix()(row, column));
}

template <typename Archive, typename Stamped>
void transfer_stamped(Archive& archive, Stamped& stamped) {
  archive(stamped.timestamp);
  transfer_pose(archive, stamped.world_from_camera);
}

void transfer_optional_pose(ByteStreamWriter& to, const std::optional<Pose>& pose) {
  to(pose.has_value());
  if (pose) transfer_pose(to, *pose);
}

void transfer_optional_pose(ByteStreamReader& from, std::optional<Pose>& pose) {
  bool known = false;
  from(known);
  pose.reset();
  if (known) transfer_pose(from, pose.emplace(Pose::Identity()));
}

template <typename Archive, typename Patch>
void transfer_patch(Archive& archive, Patch& patch) {
  archive(patch.pixel.x);
  archive(patch.pixel.y);
  archive(patch.residual);
  archive(patch.weight);
}

template <typename Archive, typename Direct>
void transfer_direct_fields(Archive& archive, Direct& d) {
  for (auto* count : {&d.reference_frame, &d.patches, &d.iterations}) archive(*count);
  archive(d.believed);
  for (auto* figure : {&d.rms_before, &d.rms_after, &d.correlation, &d.agreement, &d.share}) archive(*figure);
}

void transfer_direct(ByteStreamWriter& to, const DirectRecord& direct) {
  transfer_direct_fields(to, direct);
  to(static_cast<std::uint32_t>(direct.seen ? direct.seen->size() : 0));
  if (direct.seen)
    for (const DirectPatch& patch : *direct.seen) transfer_patch(to, patch);
}

void transfer_direct(ByteStreamReader& from, DirectRecord& direct) {
  constexpr std::size_t kPatchBytes = 16;  // bytes each: four floats
  transfer_direct_fields(from, direct);
  std::vector<DirectPatch> seen(from.count(kPatchBytes));
  for (DirectPatch& patch : seen) transfer_patch(from, patch);
  direct.seen = seen.empty() ? nullptr : std::make_shared<const std::vector<DirectPatch>>(std::move(seen));
}

void transfer_motion_figures(ByteStreamWriter& to, const std::vector<MotionFigure>& figures) {
  to(static_cast<std::uint32_t>(figures.size()));
  for (const MotionFigure& figure : figures) {
    to(figure.name);
    to(figure.value);
  }
}

void transfer_motion_figures(ByteStreamReader& from, std::vector<MotionFigure>& figures) {
  constexpr std::size_t kFigureBytes = 12;  // bytes at least: a name's length and a double
  figures.resize(from.count(kFigureBytes));
  for (MotionFigure& figure : figures) {
    from(figure.name);
    from(figure.value);
  }
}

/// What was read above the diagonal holds below it.
void mirror(Matrix6d& symmetric, int row, int column) { symmetric(column, row) = symmetric(row, column); }
void mirror(const Matrix6d&, int, int) {}

template <typename Archive, typename Record>
void transfer_fields(Archive& archive, Record& r) {
  archive(r.index);
  archive(r.timestamp);
  archive(r.status);
  archive(r.note);
  archive(r.mask_problem);
  transfer_pose(archive, r.world_from_camera);
  archive(r.estimated);
  archive(r.reference_keyframe);
  transfer_pose(archive, r.camera_from_reference);
  archive(r.pose_start);
  for (auto* count : {&r.features_found, &r.features_removed, &r.features_kept, &r.motion_rounds, &r.matches,
                      &r.inliers, &r.refine_iterations, &r.new_points, &r.fused_points, &r.culled_points,
                      &r.culled_keyframes, &r.map_points, &r.map_keyframes, &r.bundle_iterations})
    archive(*count);
  for (auto* figure : {&r.mask_share, &r.rms_px, &r.bundle_rms_before_px, &r.bundle_rms_px, &r.ms.motion,
                       &r.ms.features, &r.ms.matching, &r.ms.pose, &r.ms.mapping, &r.ms.bundle, &r.ms.total,
                       &r.ms.stereo, &r.removal_check.nothing_removed_sigma_m})
    archive(*figure);
  for (int row = 0; row < 6; ++row)  // of a symmetric matrix
    for (int column = row; column < 6; ++column) {
      archive(r.pose_covariance(row, column));
      mirror(r.pose_covariance, row, column);
    }
  archive(r.keyframe);
  for (auto* pose :
       {&r.prior_pose, &r.motion_pose, &r.removal_check.nothing_removed, &r.removal_check.truth_removed})
    transfer_optional_pose(archive, *pose);
  transfer_direct(archive, r.direct);
  transfer_motion_figures(archive, r.motion_figures);
}

/// Field by field over all features: what is alike lies together, which packs better.
template <typename Archive, typename Features>
void transfer_features(Archive& archive, Features& features) {
  for (auto& f : features) archive(f.pixel.x);
  for (auto& f : features) archive(f.pixel.y);
  for (auto& f : features) archive(f.depth);
  for (auto& f : features) archive(f.residual_px);
  for (auto& f : features) archive(f.map_point);
  for (auto& f : features) archive(f.octave);
  for (auto& f : features) archive(f.fate);
  for (auto& f : features) archive(f.static_weight);
}

template <typename Archive, typename Scores>
void transfer_scores(Archive& archive, Scores& s) {
  archive(s.known);
  for (auto* mask : {&s.mask, &s.partial_mask})
    for (auto* pixels : {&mask->found_rightly, &mask->found_wrongly, &mask->missed, &mask->left_rightly})
      archive(*pixels);
  for (auto* features : {&s.removal.removed_rightly, &s.removal.removed_wrongly, &s.removal.kept_wrongly,
                         &s.removal.kept_rightly})
    archive(*features);
  archive(s.dynamic_inliers);
}

template <typename Archive, typename SavedKeyframeType>
void transfer_keyframe(Archive& archive, SavedKeyframeType& keyframe) {
  archive(keyframe.id);
  archive(keyframe.frame_index);
  transfer_stamped(archive, keyframe.pose);
}

template <typename Archive, typename SavedPointType>
void transfer_point(Archive& archive, SavedPointType& point) {
  archive(point.id);
  for (int i = 0; i < 3; ++i) archive(point.position[i]);
  archive(point.observations);
  archive(point.moved);
  for (int i = 0; i < 3; ++i) archive(point.colour[i]);
}

// Bytes each, at least: more features than the bytes left can hold are damage.
constexpr std::size_t kFeatureBytes = 26;

template <typename Things, typename Transfer>
void write_all(ByteStreamWriter& to, const Things& things, const Transfer& transfer) {
  to(static_cast<std::uint32_t>(things.size()));
  for (const auto& thing : things) transfer(to, thing);
}

template <typename Thing, typename Transfer>
std::vector<Thing> read_all(ByteStreamReader& from, const Transfer& transfer) {
  ByteStreamWriter one;  // all are of one size
  const Thing example{};
  transfer(one, example);
  std::vector<Thing> things(from.count(one.bytes().size()));
  for (Thing& thing : things) transfer(from, thing);
  return things;
}

constexpr std::uint16_t kLargestSide = 16384;  // px, as image files have it

// Sixteen bits a run; a longer one goes on after a run of none.
constexpr std::size_t kLongestRun = 0xFFFF;

void put_run(PackedMask& pack, std::size_t length) {
  while (length > kLongestRun) {
    pack.insert(pack.end(), {0xFF, 0xFF, 0, 0});
    length -= kLongestRun;
  }
  pack.push_back(static_cast<std::uint8_t>(length & 0xFFU));
  pack.push_back(static_cast<std::uint8_t>(length >> 8U));
}

/// How many pixels of a row are alike, from its first on: set, or not. Most runs are long.
std::size_t begins_with_run(std::span<const std::uint8_t> row, bool set) {
  if (row.empty()) return 0;
  if (set) {
    const void* end = std::memchr(row.data(), 0, row.size());
    return end == nullptr ? row.size()
                          : static_cast<std::size_t>(static_cast<const std::uint8_t*>(end) - row.data());
  }
  std::size_t length = 0;
  for (std::uint64_t eight = 0; length + sizeof(eight) <= row.size(); length += sizeof(eight)) {
    std::memcpy(&eight, row.data() + length, sizeof(eight));
    if (eight != 0) break;
  }
  while (length < row.size() && row[length] == 0) ++length;
  return length;
}

}  // namespace

PackedMask pack_mask(const cv::Mat& mask) {
  PackedMask pack;
  if (mask.empty()) return pack;
  for (const int side : {mask.cols, mask.rows}) put_run(pack, static_cast<std::size_t>(side));
  bool set = false;
  std::size_t length = 0;
  for (int y = 0; y < mask.rows; ++y) {
    std::span<const std::uint8_t> row(mask.ptr<std::uint8_t>(y), static_cast<std::size_t>(mask.cols));
    while (true) {
      const std::size_t more = begins_with_run(row, set);
      length += more;
      row = row.subspan(more);
      if (row.empty()) break;
      put_run(pack, length);
      length = 0;
      set = !set;
    }
  }
  put_run(pack, length);
  return pack;
}

cv::Size check_mask(const PackedMask& pack) {
  if (pack.empty()) return {};
  ByteStreamReader from(pack);
  std::uint16_t width = 0, height = 0, length = 0;
  from(width);
  from(height);
  if (width > kLargestSide || height > kLargestSide) throw ByteStreamReader::Exhausted();
  std::size_t left = std::size_t{width} * height;
  while (!from.empty()) {
    from(length);
    if (length > left) throw ByteStreamReader::Exhausted();
    left -= length;
  }
  if (left != 0) throw ByteStreamReader::Exhausted();
  return {width, height};
}

cv::Mat unpack_mask(const PackedMask& pack) {
  const cv::Size size = check_mask(pack);
  if (size.empty()) return {};
  cv::Mat mask(size, CV_8UC1, cv::Scalar(0));
  ByteStreamReader from(pack);
  std::uint16_t length = 0;
  from(length), from(length);  // the sides
  std::uint8_t* at = mask.data;
  for (bool set = false; !from.empty(); set = !set) {
    from(length);
    if (set) std::fill_n(at, length, std::uint8_t{255});
    at += length;
  }
  return mask;
}

void write_record_figures(ByteStreamWriter& to, const FrameRecord& record) { transfer_fields(to, record); }

FrameRecord read_record_figures(ByteStreamReader& from) {
  FrameRecord record;
  transfer_fields(from, record);
  // What names a kind is looked up by it later.
  if (record.status > FrameStatus::unreadable || record.pose_start > PoseStart::direct)
    throw ByteStreamReader::Exhausted();
  return record;
}

void write_record(ByteStreamWriter& to, const FrameRecord& record) {
  write_record_figures(to, record);
  to(static_cast<std::uint32_t>(record.features.size()));
  transfer_features(to, record.features);
}

FrameRecord read_record(ByteStreamReader& from) {
  FrameRecord record = read_record_figures(from);
  record.features.resize(from.count(kFeatureBytes));
  transfer_features(from, record.features);
  if (!std::all_of(record.features.begin(), record.features.end(),
                   [](const FeatureRecord& f) { return f.fate <= FeatureFate::removed; }))
    throw ByteStreamReader::Exhausted();
  return record;
}

void write_end(ByteStreamWriter& to, const RunResult& run, const Trajectory& ground_truth) {
  write_all(to, run.scores, [](auto& a, auto& s) { transfer_scores(a, s); });
  write_all(to, run.keyframes, [](auto& a, auto& k) { transfer_keyframe(a, k); });
  for (const auto* points : {&run.points, &run.moved})
    write_all(to, *points, [](auto& a, auto& p) { transfer_point(a, p); });
  write_all(to, run.trajectory, [](auto& a, auto& p) { transfer_stamped(a, p); });
  write_all(to, ground_truth, [](auto& a, auto& p) { transfer_stamped(a, p); });
  to(run.orb_unit_ms);
  to(run.interrupted);
}

RunEnd read_end(ByteStreamReader& from) {
  RunEnd end;
  end.scores = read_all<FrameScores>(from, [](auto& a, auto& s) { transfer_scores(a, s); });
  end.keyframes = read_all<SavedKeyframe>(from, [](auto& a, auto& k) { transfer_keyframe(a, k); });
  for (auto* points : {&end.points, &end.moved})
    *points = read_all<SavedPoint>(from, [](auto& a, auto& p) { transfer_point(a, p); });
  end.trajectory = read_all<StampedPose>(from, [](auto& a, auto& p) { transfer_stamped(a, p); });
  end.ground_truth = read_all<StampedPose>(from, [](auto& a, auto& p) { transfer_stamped(a, p); });
  from(end.orb_unit_ms);
  from(end.interrupted);
  return end;
}

}  // namespace stillpoint
