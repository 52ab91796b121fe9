#include "core/motion/motion_stage.hpp"

#include <algorithm>

namespace stillpoint {
namespace {

std::unique_ptr<MotionMethod> cloned(const std::unique_ptr<MotionMethod>& method) {
  return method ? method->clone() : nullptr;
}

const MethodInfo* stand_in_of(const MethodInfo& info) {
  return info.without_depth.empty() ? nullptr : &method_named(info.without_depth);
}

/// What a method made of a frame, and the masks made elsewhere that belong to it.
struct WithOutside final : MotionPreparation {
  std::shared_ptr<const MotionPreparation> own;
  std::shared_ptr<const OutsideMask> outside;
};

/// What the method itself prepared.
std::shared_ptr<const MotionPreparation> own_of(const std::shared_ptr<const MotionPreparation>& preparation) {
  const auto* both = dynamic_cast<const WithOutside*>(preparation.get());
  return both == nullptr ? preparation : both->own;
}

std::unique_ptr<MotionMethod> made(const MethodInfo* info, const Camera& camera, const Config& config) {
  return info == nullptr ? nullptr : info->make(camera, config);
}

}  // namespace

MotionPreparer::MotionPreparer(const Camera& camera, const Config& config)
    : method_(made(&method_of(config), camera, config)),
      stand_in_(made(stand_in_of(method_of(config)), camera, config)),
      outside_(config) {}

MotionPreparer::MotionPreparer(const MotionPreparer& other)
    : method_(cloned(other.method_)),
      stand_in_(cloned(other.stand_in_)),
      outside_(other.outside_),
      past_(other.past_) {}

MotionPreparer& MotionPreparer::operator=(const MotionPreparer& other) {
  if (this != &other) *this = MotionPreparer(other);
  return *this;
}

std::shared_ptr<const MotionPreparation> MotionPreparer::prepare(const Frame& frame, int threads) {
  const MotionMethod& method = stand_in_ && !frame.has_depth() ? *stand_in_ : *method_;
  const std::vector<std::shared_ptr<const MotionPreparation>> past(past_.begin(), past_.end());
  auto preparation = method.prepare(frame, past, threads);
  pass(preparation);
  if (!outside_.any()) return preparation;
  auto both = std::make_shared<WithOutside>();
  both->own = std::move(preparation);
  both->outside = outside_.read(frame);
  return both;
}

void MotionPreparer::pass(const std::shared_ptr<const MotionPreparation>& prepared) {
  const std::shared_ptr<const MotionPreparation> preparation = own_of(prepared);
  if (!preparation || frames_back() == 0) return;
  const auto kept = preparation->for_later();
  past_.push_back(kept ? kept : preparation);
  while (static_cast<int>(past_.size()) > frames_back()) past_.pop_front();
}

void MotionPreparer::restore(int next, int threads, const MotionMethod::ReadFrame& read) {
  past_.clear();
  for (int i = next - 1; i >= 0 && static_cast<int>(past_.size()) < frames_back(); --i)
    if (const Frame frame = read(i); frame.readable()) past_.push_front(method_->prepare(frame, {}, threads));
}

MotionStage::MotionStage(const Camera& camera, const Config& config)
    : camera_(camera),
      config_(config),
      info_(&method_of(config)),
      stand_in_info_(stand_in_of(*info_)),
      method_(made(info_, camera, config)),
      stand_in_(made(stand_in_info_, camera, config)),
      outside_(config) {}

MotionStage::MotionStage(const MotionStage& other)
    : camera_(other.camera_),
      config_(other.config_),
      info_(other.info_),
      stand_in_info_(other.stand_in_info_),
      method_(cloned(other.method_)),
      stand_in_(cloned(other.stand_in_)),
      outside_(other.outside_),
      stand_in_used_(other.stand_in_used_) {}

MotionStage& MotionStage::operator=(const MotionStage& other) {
  if (this != &other) *this = MotionStage(other);
  return *this;
}

const MethodInfo& MotionStage::info_for(const Frame& frame) const {
  return by_stand_in(frame) ? *stand_in_info_ : *info_;
}

const MotionMethod& MotionStage::method_for(const Frame& frame) const {
  return by_stand_in(frame) ? *stand_in_ : *method_;
}

/// What the method is given of a frame: its own preparation, and the outside mask beside it.
MotionInput MotionStage::for_method(const MotionInput& input) const {
  MotionInput given = input;
  given.prepared = own_of(input.prepared);
  if (const auto* both = dynamic_cast<const WithOutside*>(input.prepared.get()))
    given.outside = both->outside;
  else if (outside_.any())
    given.outside = outside_.read(input.frame);
  return given;
}

cv::Mat MotionStage::prior_mask(const MotionInput& input) const {
  const MotionInput given = for_method(input);
  MotionResult prior;
  prior.mask = method_for(input.frame).prior_mask(given);
  combine_with_outside(config_.of<MasksConfig>(), given, prior);
  return prior.mask;
}

MotionResult MotionStage::detect(const MotionInput& input) const {
  const MotionInput given = for_method(input);
  MotionResult result = method_for(input.frame).detect(given);
  combine_with_outside(config_.of<MasksConfig>(), given, result);
  return result;
}

void MotionStage::commit(const MotionInput& input, const MotionResult& result, const MotionOutcome& outcome) {
  const MotionInput given = for_method(input);
  if (by_stand_in(input.frame)) {
    stand_in_->commit(given, result, outcome);
    stand_in_used_ = true;
    return;
  }
  // What the stand-in saw before frames with depth says nothing of those after them.
  if (stand_in_used_) stand_in_ = made(stand_in_info_, camera_, config_);
  stand_in_used_ = false;
  method_->commit(given, result, outcome);
}

StageLog MotionStage::describe(const Frame& frame, const MotionResult& result) const {
  StageLog log = method_for(frame).describe(frame, result);
  log.method = info_for(frame).name;
  describe_outside(frame, result, log);
  return log;
}

int MotionStage::frames_back() const {
  return std::max(method_->frames_back(), stand_in_ ? stand_in_->frames_back() : 0);
}

void MotionStage::drop_images() {
  method_->drop_images();
  if (stand_in_) stand_in_->drop_images();
}

std::set<int> MotionStage::images_wanted(int first, int last) const {
  std::set<int> frames = method_->images_wanted(first, last);
  if (stand_in_) frames.merge(stand_in_->images_wanted(first, last));
  return frames;
}

void MotionStage::restore_images(int first, int last, const MotionMethod::ReadFrame& read) {
  method_->restore_images(first, last, read);
  if (stand_in_) stand_in_->restore_images(first, last, read);
}

/// The method's state under another config; null where it does not serve.
std::unique_ptr<MotionMethod> MotionStage::kept_under(const Config& config) const {
  if (config.run.method != config_.run.method) return nullptr;
  if (config.methods == config_.methods) return method_->clone();
  return method_->with_config(config);
}

int MotionStage::frames_wanted(const Config& config) const {
  // A stand-in that has not been called on since the last frame with depth is as new.
  const bool stand_in_serves = !stand_in_ || !stand_in_used_ || config.methods == config_.methods;
  if (stand_in_serves && kept_under(config)) return 0;
  return MotionStage(camera_, config).frames_back();
}

MotionStage MotionStage::continued_with(const Config& config, const std::vector<PastFrame>& before) const {
  MotionStage next(camera_, config);
  std::unique_ptr<MotionMethod> kept = kept_under(config);
  const bool same_stand_in = config.methods == config_.methods && config.run.method == config_.run.method;
  MotionPreparer preparer(camera_, config);
  for (const PastFrame& past : before) {
    if (!past.frame.readable()) continue;
    MotionInput input{past.frame, preparer.prepare(past.frame, config.run.threads), past.camera_from_world};
    input.threads = config.run.threads;
    const MotionNeeds& needs = next.info_for(past.frame).needs;
    next.commit(input, needs.first_pose || needs.true_mask ? MotionResult{} : next.detect(input),
                {past.estimated, past.camera_from_world});
  }
  if (kept) next.method_ = std::move(kept);
  if (same_stand_in) {
    next.stand_in_ = cloned(stand_in_);
    next.stand_in_used_ = stand_in_used_;
  }
  return next;
}

}  // namespace stillpoint
