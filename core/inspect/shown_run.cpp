#include "core/inspect/shown_run.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/error.hpp"
#include "core/inspect/frame_neighbours.hpp"
#include "core/inspect/run_view.hpp"
#include "core/odometry/engines.hpp"

namespace stillpoint {
namespace {

constexpr std::size_t kExtrasKept = 4;  // each some megabytes

/// A record with other features taken out; what was matched, and the pose, stay as they were.
FrameRecord with_mask(FrameRecord record, const cv::Mat& mask) {
  for (FeatureRecord& feature : record.features) {
    const bool was_removed = feature.fate == FeatureFate::removed;
    const bool removed =
        !mask.empty() && mask.at<uchar>(cvRound(feature.pixel.y), cvRound(feature.pixel.x)) != 0;
    if (removed == was_removed) continue;
    feature.fate = removed ? FeatureFate::removed : FeatureFate::unmatched;
    if (removed) feature.map_point = kNone;
    record.features_removed += removed ? 1 : -1;
  }
  record.features_kept = record.features_found - record.features_removed;
  record.mask_share =
      mask.empty() ? 0.0 : static_cast<double>(cv::countNonZero(mask)) / static_cast<double>(mask.total());
  return record;
}

/// The engine's own stages; null where the record tells all of them.
std::shared_ptr<const StageLog> engine_stages(const Config& config, const Frame& frame,
                                              const EngineTrace* trace) {
  if (!engine_of(config).has_stages) return nullptr;
  StageLog log;
  log.method = config.run.odometry;
  if (trace != nullptr && frame.readable())
    log.stages = trace->describe(frame);
  else
    log.note = "the engine's stages are at hand once this frame has been processed here";
  return std::make_shared<const StageLog>(std::move(log));
}

}  // namespace

std::shared_ptr<const FrameView> hold(FrameView view, std::optional<FrameRecord> record) {
  struct Shown {
    FrameView view;
    FrameRecord record;
  };
  auto shown = std::make_shared<Shown>();
  shown->view = std::move(view);
  if (record) {
    shown->record = std::move(*record);
    shown->view.record = &shown->record;
  }
  const FrameView* held = &shown->view;
  return {std::move(shown), held};
}

void ShownRun::process(const Frame& frame) {
  // A recorded run is shown the frames before, too, which it was not shown yet.
  FrameResult result =
      track_.process_next([&](int index) { return index == frame.index ? frame : frames_->read(index); });
  view_.reset();
  keep({frame.index, std::move(result.motion), std::move(result.mask), std::move(result.engine)});
}

std::optional<FrameRecord> ShownRun::record_without_features(int index) const {
  if (index >= track_.processed()) return std::nullopt;
  return track_.records()[static_cast<std::size_t>(index)];
}

void ShownRun::keep(Extras extras) {
  extras_.push_front(std::move(extras));
  if (extras_.size() > kExtrasKept) extras_.pop_back();
}

ShownRun::Extras ShownRun::extras_of(int index) {
  const auto kept =
      std::find_if(extras_.begin(), extras_.end(), [&](const Extras& e) { return e.index == index; });
  if (kept != extras_.end()) return *kept;
  Extras extras{.index = index};
  if (const std::string name = track_.outside(); !name.empty()) {
    extras.mask = track_.recorded_mask(index);
    extras.note = fmt::format("{} was run by another program, and its stages are not known here", name);
    return extras;
  }
  // An engine's own stages are in no record: the frame is processed again.
  const bool again_whole = engine_of(track_.config()).has_stages && is_own(index) && index < track_.seen();
  if (!again_whole && track_.can_repeat_motion(index)) {
    MotionReplay motion = motion_before(index);
    const std::optional<FrameRecord> record = record_without_features(index);
    MotionAgain again = motion.repeat(frames_->read(index), record ? &*record : nullptr,
                                      track_.true_mask_used(track_.config(), index));
    extras.motion = std::move(again.motion);
    extras.mask = std::move(again.mask);
  } else if (!is_own(index)) {
    extras.note = "the frame has not been processed yet";
    return extras;
  } else if (index >= track_.seen()) {
    extras.mask = track_.recorded_mask(index);
    extras.note =
        "the run's records hold the mask alone, and the stages before it are computed again from the first "
        "frame on";
    return extras;
  } else {
    FrameResult again = process_again(index, track_.config());
    extras.motion = std::move(again.motion);
    extras.mask = std::move(again.mask);
    extras.engine = std::move(again.engine);
  }
  keep(extras);
  return extras;
}

bool ShownRun::set_out_for(int index) {
  constexpr std::size_t kAtOnce = 4;  // frames: about the work of a step
  // On the way to an earlier frame, or beyond it, it may serve for a later one.
  const bool serves =
      before_ && before_->way.next <= index && before_->way.next >= track_.checkpoint_before(index);
  if (!serves) {
    before_.reset();
    if (!to_read_ || to_read_->first != index) to_read_.emplace(index, track_.frames_to_restore(index));
    std::set<int> next;
    while (!to_read_->second.empty() && next.size() < kAtOnce)
      next.insert(to_read_->second.extract(to_read_->second.begin()).value());
    frames_->read_ahead(next);
    if (!to_read_->second.empty()) return false;
    before_.emplace(Before{.index = index, .way = track_.rewound(index, reader())});
  }
  to_read_.reset();
  before_->index = index;
  before_->frames = std::make_unique<Prefetcher>(*source_, before_->way.next, index, 2);
  return true;
}

bool ShownRun::prepare_preview(int index) {
  if (!is_own(index) || !track_.outside().empty()) return true;
  if ((!before_ || before_->index != index) && !set_out_for(index)) return false;
  ReplayableRun::Rewound& way = before_->way;
  if (way.next < index) {
    (void)track_.process(way.odometry, way.next, [this](int) { return before_->frames->next(); });
    ++way.next;
  }
  if (way.next == index) before_->frames.reset();
  return way.next == index;
}

const MotionReplay& ShownRun::motion_before(int index) {
  if (!motion_before_ || motion_before_->first != index) {
    frames_->read_ahead(track_.frames_to_repeat(index));
    motion_before_.emplace(index, track_.motion_before(index, reader()));
  }
  return motion_before_->second;
}

std::optional<MotionAgain> ShownRun::motion_again(int index, const Config& config) {
  const MotionNeeds& needs = method_of(config).needs;
  if (needs.matches || (needs.first_pose && !is_own(index))) return std::nullopt;
  if (needs.keeps_state && !track_.outside().empty()) return std::nullopt;
  const std::optional<FrameRecord> record = record_without_features(index);
  const auto repeat = [&](MotionReplay motion) {
    return motion.repeat(frames_->read(index), record ? &*record : nullptr,
                         track_.true_mask_used(config, index));
  };
  if (!needs.keeps_state && !needs.first_pose)
    return repeat(
        {source_->camera(), config, MotionStage(source_->camera(), config), index, index, reader()});
  // Where the run's own state cannot be had, the frames right before stand for what was before them.
  const MotionReplay here = track_.can_repeat_motion(index)
                                ? motion_before(index)
                                : MotionReplay(source_->camera(), track_.config());
  const int wanted = std::min(index, here.frames_wanted(config));
  if (index > track_.processed()) return std::nullopt;
  return repeat(here.continued_with(config, track_.frames_before(index, wanted, reader())));
}

FrameResult ShownRun::process_again(int index, const Config& config) {
  if (!track_.outside().empty())
    throw InputError(
        fmt::format("{} was run by another program: only that can process a frame again", track_.outside()));
  while (!prepare_preview(index)) {
  }
  const Odometry& here = before_->way.odometry;
  if (config == track_.config()) {
    Odometry odometry = here;
    return track_.process(odometry, index, reader());
  }
  std::optional<Odometry> odometry =
      here.continued_with(config, track_.frames_before(index, here.frames_wanted(config), reader()));
  if (!odometry)
    throw InputError(
        "another odometry, features.levels and features.scale_factor take effect only when all is run anew");
  return track_.process(*odometry, index, reader());
}

FrameView ShownRun::images_of(int index, const Config& config, Extras extras) {
  FrameView view;
  view.index = index;
  if (index > 0) frames_->read_ahead({index - 1, index});
  view.frame = frames_->read(index);
  view.truth = source_->truth(index);
  StageLog log;
  if (view.frame.readable() && extras.note.empty())
    log = MotionStage(source_->camera(), config).describe(view.frame, extras.motion);
  if (log.method.empty()) log.method = track_.outside().empty() ? config.run.method : track_.outside();
  if (log.note.empty()) log.note = extras.note;
  view.reference.index = log.reference >= 0 ? log.reference : index - 1;
  if (view.reference.index >= 0) view.reference = frames_->read(view.reference.index);
  view.motion = std::make_shared<const StageLog>(std::move(log));
  view.odometry = engine_stages(config, view.frame, extras.engine.get());
  view.mask = std::move(extras.mask);
  // Without its images, a finished run still tells what it removed.
  if (!view.frame.readable() && view.mask.empty()) view.mask = track_.recorded_mask(index);
  if (!beside_.empty() && beside_ != config.run.method) view.motion_beside = stages_beside(index);
  if (!track_.keeps_times()) clear_times(view);
  return view;
}

std::shared_ptr<const StageLog> ShownRun::stages_beside(int index) {
  Config config = track_.config();
  config.run.method = beside_;
  const Frame frame = frames_->read(index);
  StageLog log;
  if (const auto again = frame.readable() ? motion_again(index, config) : std::nullopt)
    log = MotionStage(source_->camera(), config).describe(frame, again->motion);
  else
    log.note = "its stages need this run to have come here by that method";
  log.method = beside_;
  return std::make_shared<const StageLog>(std::move(log));
}

std::shared_ptr<const FrameView> ShownRun::frame_view(int index, std::shared_ptr<const FrameView> before) {
  FrameView view = images_of(index, track_.config(), extras_of(index));
  const bool processed = index < track_.processed();
  if (processed) {
    view.history = history_of(index, [this](int past) { return track_.record(past); });
    view.before = std::move(before);
  }
  return hold(std::move(view), processed ? std::optional(track_.record(index)) : std::nullopt);
}

std::shared_ptr<const FrameView> ShownRun::record_view(int index) {
  FrameView view;
  view.index = index;
  view.frame = frames_->read(index);
  return hold(std::move(view), track_.record(index));
}

std::shared_ptr<const FrameView> ShownRun::image_view(int index) {
  FrameView view;
  view.index = index;
  view.frame = frames_->read(index);
  view.image_alone = true;
  return hold(std::move(view), std::nullopt);
}

bool ShownRun::has_at_hand(int index) const {
  return std::any_of(extras_.begin(), extras_.end(), [&](const Extras& e) { return e.index == index; });
}

std::shared_ptr<const RunView> ShownRun::run_view() {
  if (!view_) view_ = std::make_shared<const RunView>(track_.view());
  return view_;
}

std::shared_ptr<const FrameView> ShownRun::motion_preview(int index, const Config& config) {
  std::optional<MotionAgain> again = motion_again(index, config);
  if (!again) return nullptr;
  Extras extras{.index = index, .motion = std::move(again->motion), .mask = std::move(again->mask)};
  FrameView view = images_of(index, config, std::move(extras));
  std::optional<FrameRecord> record;
  if (is_own(index)) record = with_mask(track_.record(index), view.mask);
  return with_history(std::move(view), std::move(record));
}

std::shared_ptr<const FrameView> ShownRun::preview(int index, const Config& config) {
  Extras extras{.index = index};
  std::optional<FrameRecord> record;
  if (is_own(index)) {
    FrameResult result = process_again(index, config);
    record = std::move(result.record);
    extras = {index, std::move(result.motion), std::move(result.mask), std::move(result.engine)};
  }
  return with_history(images_of(index, config, std::move(extras)), std::move(record));
}

std::shared_ptr<const FrameView> ShownRun::with_history(FrameView view,
                                                        std::optional<FrameRecord> record) const {
  if (record) view.history = history_of(view.index, [this](int past) { return track_.record(past); });
  return hold(std::move(view), std::move(record));
}

}  // namespace stillpoint
