#include "core/run/outside_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <optional>
#include <utility>

#include "core/error.hpp"
#include "core/evaluation/clocks.hpp"
#include "core/motion/methods.hpp"
#include "core/odometry/frame_result.hpp"
#include "core/run/estimate_file.hpp"
#include "core/run/frame_scores.hpp"
#include "core/run/run_folder.hpp"
#include "core/run/run_report.hpp"
#include "core/sequence/association.hpp"
#include "core/sequence/mask_files.hpp"
#include "core/text_file.hpp"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;

constexpr const char* kMaskNames[] = {"masks", "mask", "masks.txt", "mask.txt"};
constexpr const char* kFeaturesName = "features.csv";

bool is_file(const fs::path& path) {
  std::error_code none;
  return fs::is_regular_file(path, none);
}

std::optional<std::string> masks_in(const fs::path& folder) {
  std::error_code none;
  for (const char* name : kMaskNames)
    if (fs::exists(folder / name, none)) return folder / name;
  return std::nullopt;
}

/// The frame nearest in time, within the tolerance.
class FrameFinder {
 public:
  explicit FrameFinder(const FrameSource& source) {
    for (int i = 0; i < source.size(); ++i) stamps_.push_back(source.timestamp(i));
  }
  [[nodiscard]] std::optional<std::size_t> at(double timestamp) const {
    const auto after = std::lower_bound(stamps_.begin(), stamps_.end(), timestamp);
    auto nearest = after;
    if (after == stamps_.end() ||
        (after != stamps_.begin() && timestamp - *(after - 1) <= *after - timestamp))
      if (after != stamps_.begin()) nearest = after - 1;
    if (nearest == stamps_.end() || std::abs(*nearest - timestamp) >= kAssociationTolerance)
      return std::nullopt;
    return static_cast<std::size_t>(nearest - stamps_.begin());
  }
  [[nodiscard]] const std::vector<double>& stamps() const { return stamps_; }

 private:
  std::vector<double> stamps_;
};

std::optional<FeatureFate> fate_of(std::string_view word) {
  static const std::map<std::string_view, FeatureFate> kFates = {{"inlier", FeatureFate::inlier},
                                                                 {"outlier", FeatureFate::outlier},
                                                                 {"removed", FeatureFate::removed},
                                                                 {"unmatched", FeatureFate::unmatched},
                                                                 {"kept", FeatureFate::unmatched}};
  const auto found = kFates.find(word);
  return found == kFates.end() ? std::nullopt : std::optional(found->second);
}

/// An id as a table gives it; kNone for what is none.
int whole_or_none(const std::optional<double>& number) {
  constexpr double kLargest = 2e9;  // an id that fits an int
  return number && *number >= 0 && *number <= kLargest ? static_cast<int>(*number) : kNone;
}

/// `features.csv`: a head that names the columns stamp (or frame), x, y, state, id, point, then a feature a
/// row.
class FeatureTable {
 public:
  FeatureTable(const std::string& path, const FrameFinder& frames, std::vector<FrameRecord>& records)
      : path_(path), frames_(frames), records_(records) {
    const std::string text = read_text(path);
    const std::vector<TextLine> lines = text_lines(text);
    if (lines.empty())
      throw InputError(fmt::format("{}: is empty, expected a head and a feature a row", path));
    read_head(lines.front());
    for (std::size_t i = 1; i < lines.size(); ++i) read_row(lines[i]);
  }

  void tell(std::vector<std::string>& warnings) const {
    if (malformed_ > 0)
      warnings.push_back(fmt::format("{} ({} rows in all were passed over)", first_, malformed_));
    if (elsewhere_ > 0)
      warnings.push_back(fmt::format("{}: {} rows belong to no frame of the sequence and were passed over",
                                     path_, elsewhere_));
  }

 private:
  void read_head(const TextLine& head) {
    const auto names = split_columns(head.text);
    for (std::size_t i = 0; i < names.size(); ++i) column_[std::string(names[i])] = static_cast<int>(i);
    columns_ = names.size();
    by_number_ = column_.count("frame") > 0;
    for (const char* name : {"x", "y", "state"})
      if (column_.count(name) == 0)
        throw InputError(fmt::format("{}:{}: names no column {}, expected stamp,x,y,state,id,point", path_,
                                     head.number, name));
    if (!by_number_ && column_.count("stamp") == 0)
      throw InputError(fmt::format("{}:{}: names neither a column stamp nor frame", path_, head.number));
  }

  void read_row(const TextLine& line) {
    const auto cells = split_columns(line.text);
    const auto number = [&](const char* name) -> std::optional<double> {
      const auto column = column_.find(name);
      return column == column_.end() ? std::nullopt
                                     : parse_number(cells[static_cast<std::size_t>(column->second)]);
    };
    std::optional<double> when, x, y;
    std::optional<FeatureFate> fate;
    if (cells.size() == columns_) {
      when = number(by_number_ ? "frame" : "stamp"), x = number("x"), y = number("y");
      fate = fate_of(cells[static_cast<std::size_t>(column_["state"])]);
    }
    constexpr double kFarthest = 1e6;  // px: what is farther out lies in no image
    if (!when || !x || !y || !fate || !(std::abs(*x) < kFarthest) || !(std::abs(*y) < kFarthest)) {
      if (malformed_++ == 0)
        first_ = fmt::format(
            "{}:{}: is no feature; expected numbers, and a state of inlier, outlier, removed, unmatched or "
            "kept",
            path_, line.number);
      return;
    }
    const std::optional<std::size_t> frame = frame_of(*when);
    if (!frame) {
      ++elsewhere_;
      return;
    }
    FeatureRecord feature;
    feature.pixel = cv::Point2f(static_cast<float>(*x), static_cast<float>(*y));
    feature.fate = *fate;
    const auto point = number("point"), id = number("id");
    if (feature.fate == FeatureFate::inlier || feature.fate == FeatureFate::outlier)
      feature.map_point = whole_or_none(point ? point : id);
    records_[*frame].features.push_back(feature);
  }

  [[nodiscard]] std::optional<std::size_t> frame_of(double when) const {
    if (!by_number_) return frames_.at(when);
    if (!(when >= 0) || when >= static_cast<double>(records_.size())) return std::nullopt;
    return static_cast<std::size_t>(when);
  }

  const std::string& path_;
  const FrameFinder& frames_;
  std::vector<FrameRecord>& records_;
  std::map<std::string, int> column_;
  std::size_t columns_ = 0;
  bool by_number_ = false;
  int malformed_ = 0, elsewhere_ = 0;
  std::string first_;
};

/// The trajectory in seconds of the sequence's clock.
Trajectory read_poses(const FrameSource& source, const FrameFinder& frames, const OutsideRunFiles& files,
                      const std::string& path, std::vector<std::string>& warnings) {
  TrajectoryFile file = read_estimate_file(path, files.quaternion);
  warnings.insert(warnings.end(), file.warnings.begin(), file.warnings.end());
  for (StampedPose& pose : file.poses)
    pose.world_from_camera = camera_pose(pose.world_from_camera, files.convention);
  // Numbers are of the whole recording's frames, however many are looked at.
  const std::vector<double> recorded = source.recorded_stamps();
  if (std::string laid = lay_rows_on_frames(file, recorded, source.ground_truth(), path); !laid.empty())
    warnings.push_back(std::move(laid));
  Trajectory clock;  // the frames' own stamps, which is all that a clock is settled by
  for (const double stamp : frames.stamps()) clock.push_back({stamp, Pose::Identity()});
  ClockOptions options;
  options.truth_name = source.name(), options.estimate_name = path;
  options.truth_in_seconds = true;
  options.frame_stamps = recorded;
  options.estimate_offset_s = files.time_offset_s;
  const auto notes = settle_clocks(clock, file.poses, options);
  warnings.insert(warnings.end(), notes.begin(), notes.end());
  if (std::none_of(file.poses.begin(), file.poses.end(),
                   [&](const StampedPose& pose) { return frames.at(pose.timestamp).has_value(); }))
    throw InputError(fmt::format("{}: none of its {} poses is closer than {} s to a frame of {}; {}", path,
                                 file.poses.size(), kAssociationTolerance, source.name(),
                                 why_apart(clock, file.poses, options)));
  return std::move(file.poses);
}

/// Takes out the poses before the first frame and after the last, which frames that are run are not measured
/// by either.
void leave_out_beyond(const FrameFinder& frames, const std::string& path, Trajectory& poses,
                      std::vector<std::string>& warnings) {
  const double begin = frames.stamps().front() - kAssociationTolerance,
               end = frames.stamps().back() + kAssociationTolerance;
  if (const auto out = std::erase_if(
          poses, [&](const StampedPose& pose) { return pose.timestamp < begin || pose.timestamp > end; });
      out > 0)
    warnings.push_back(
        fmt::format("{}: {} of its poses lie before the first frame or after the last, and are "
                    "left out",
                    path, out));
}

/// A record a frame: where the trajectory has a pose, and where it has none.
std::vector<FrameRecord> lay_onto_frames(const Trajectory& poses, const FrameFinder& frames) {
  std::vector<FrameRecord> records(frames.stamps().size());
  std::vector<double> off(records.size(), kAssociationTolerance);  // s, of the pose taken
  for (std::size_t i = 0; i < records.size(); ++i) {
    records[i].index = static_cast<int>(i);
    records[i].timestamp = frames.stamps()[i];
  }
  for (const StampedPose& pose : poses) {
    const auto at = frames.at(pose.timestamp);
    if (!at) continue;
    const double apart = std::abs(pose.timestamp - frames.stamps()[*at]);
    if (records[*at].estimated && apart >= off[*at]) continue;
    off[*at] = apart;
    records[*at].estimated = true;
    records[*at].world_from_camera = pose.world_from_camera;
  }
  Pose last = Pose::Identity();
  bool begun = false;
  for (FrameRecord& record : records) {
    if (record.estimated) {
      record.status = begun ? FrameStatus::tracked : FrameStatus::initialised;
      begun = true;
      last = record.world_from_camera;
    } else {
      record.status = FrameStatus::lost;
      record.note = "the trajectory has no pose for this frame";
      record.world_from_camera = last;
    }
  }
  return records;
}

void count_features(FrameRecord& record) {
  const auto count = [&record](FeatureFate fate) {
    return static_cast<int>(std::count_if(record.features.begin(), record.features.end(),
                                          [fate](const FeatureRecord& f) { return f.fate == fate; }));
  };
  record.features_found = static_cast<int>(record.features.size());
  record.features_removed = count(FeatureFate::removed);
  record.features_kept = record.features_found - record.features_removed;
  record.inliers = count(FeatureFate::inlier);
  record.matches = record.inliers + count(FeatureFate::outlier);
}

}  // namespace

OutsideRunFiles outside_run_argument(const std::string& text) {
  OutsideRunFiles files;
  const std::size_t equals = text.find('=');
  files.where = equals == std::string::npos ? text : text.substr(equals + 1);
  if (files.where.empty()) throw InputError(fmt::format("'{}' names no run: write NAME=FILE", text));
  const fs::path path = fs::path(files.where).lexically_normal();
  files.name = equals == std::string::npos
                   ? (path.filename().empty() ? path.parent_path() : path).filename().string()
                   : text.substr(0, equals);
  return files;
}

RecordedRun read_outside_run(const FrameSource& source, const SequenceOrigin& origin,
                             const OutsideRunFiles& files, std::vector<std::string>& warnings,
                             const std::function<void(const FrameRecord&)>& between) {
  std::error_code none;
  if (!fs::exists(files.where, none))
    throw InputError(fmt::format("{}: there is no such file or folder", files.where));
  const bool folder = fs::is_directory(files.where, none);
  const std::string path = folder ? trajectory_in(files.where) : files.where;
  const FrameFinder frames(source);
  RecordedRun recorded;
  recorded.outside = files.name;
  recorded.origin = origin;
  recorded.ground_truth = source.ground_truth();
  RunResult& run = recorded.run;
  run.config.run.method = baseline_method().name;
  run.frames_in_sequence = source.size();
  run.trajectory = read_poses(source, frames, files, path, warnings);
  leave_out_beyond(frames, path, run.trajectory, warnings);
  std::vector<FrameRecord> records = lay_onto_frames(run.trajectory, frames);
  for (const FrameRecord& record : records)
    if (record.estimated) run.live.push_back({record.timestamp, record.world_from_camera});
  std::vector<FrameScores> scores(records.size());
  std::vector<FrameDetails::Detail> details(records.size());
  bool has_features = false;
  std::optional<MaskFiles> masks;
  if (folder) {
    if (const std::string table = fs::path(files.where) / kFeaturesName; is_file(table)) {
      const FeatureTable features(table, frames, records);
      features.tell(warnings);
      has_features = true;
    }
    if (const auto found = masks_in(files.where)) {
      masks.emplace(*found, MaskReading{});
      warnings.insert(warnings.end(), masks->warnings().begin(), masks->warnings().end());
    }
  }
  const bool scored = source.has_masks() && (has_features || masks);
  for (FrameRecord& record : records) tell_parts_of_outside(record, false);
  for (std::size_t i = 0; (masks || has_features) && i < records.size(); ++i) {
    FrameResult result;
    result.record = std::move(records[i]);
    count_features(result.record);
    if (masks) {
      FoundMask found = masks->read(source.read(static_cast<int>(i)));
      result.record.mask_problem = std::move(found.problem);
      result.mask = std::move(found.mask);
      if (!result.mask.empty())
        result.record.mask_share =
            static_cast<double>(cv::countNonZero(result.mask)) / static_cast<double>(result.mask.total());
      details[i].mask = pack_mask(result.mask);
    }
    if (scored && (!masks || !result.mask.empty()))
      scores[i] = score_frame(result, source.truth(static_cast<int>(i)).moving, !masks);
    tell_parts_of_outside(result.record, !result.mask.empty());
    details[i].features = std::exchange(result.record.features, {});
    records[i] = std::move(result.record);
    if (between) between(records[i]);
  }
  run.records = FrameRecords(std::move(records));
  run.scores = ScoreList(std::move(scores));
  recorded.details = details_at_hand(std::move(details));
  recorded.hash = run_hash(run.records);
  return recorded;
}

void tell_parts_of_outside(FrameRecord& record, bool mask) {
  record.measured = poses_alone();
  record.measured.mask = mask;
  // A table of features without a row for the frame leaves it untold.
  record.measured.features = record.measured.matches = record.features_found > 0;
  record.rms_px = std::numeric_limits<double>::quiet_NaN();
}

void write_outside_run(const std::string& folder, const RecordedRun& run, const FrameSource& source) {
  const bool masks = std::any_of(run.run.records.begin(), run.run.records.end(),
                                 [](const FrameRecord& record) { return record.measured.mask; });
  RecordsWriter records(folder, run.origin, run.run.config, run.outside, masks);
  for (std::size_t i = 0; i < run.run.records.size(); ++i) {
    FrameResult frame;
    frame.record = run.record(i);
    frame.mask = run.mask(i);
    records.add(frame);
  }
  RunReport report = report_on(run.run, source);
  report.method = run.outside;
  report.odometry = "its own";
  write_run(folder, run.run, report, source, run.origin, records);
}

}  // namespace stillpoint
