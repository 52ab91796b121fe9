// Method `stillpoint`: every frame against two earlier ones, in depth and brightness, under a first pose;
// evidence is kept as log-odds, the next frame's prior.
#include <algorithm>
#include <mutex>
#include <vector>

#include "core/byte_store.hpp"
#include "core/motion/methods.hpp"
#include "core/motion/stillpoint/depth_evidence.hpp"
#include "core/motion/stillpoint/depth_motion.hpp"
#include "core/motion/stillpoint/stillpoint_stages.hpp"
#include "core/motion/stillpoint/superpixels.hpp"

namespace stillpoint {
namespace {

struct Preparation final : MotionPreparation {
  std::shared_ptr<const RgbdView> view;
  Superpixels superpixels;
};

/// A downsampled frame that was tracked, and from where. A session keeps a copy of them all after each frame:
/// what two have alike they share.
struct PastView {
  int frame_index = 0;
  std::shared_ptr<const RgbdView> view;           // null while its images are dropped
  std::shared_ptr<const Pose> camera_from_world;  // never null
};

const Preparation& prepared(const MotionInput& input) {
  return static_cast<const Preparation&>(*input.prepared);
}

/// Where the log-odds of copies lie that dropped their images: there may be very many.
std::shared_ptr<ByteStore> store_of_dropped() {
  static std::mutex mutex;
  static std::weak_ptr<ByteStore> store;
  const std::lock_guard lock(mutex);
  auto held = store.lock();
  if (!held) store = held = ByteStore::make();
  return held;
}

class StillpointMethod final : public MotionMethod {
 public:
  StillpointMethod(const Camera& camera, const StillpointConfig& config) : camera_(camera), config_(config) {}

  [[nodiscard]] std::unique_ptr<MotionMethod> clone() const override {
    return std::make_unique<StillpointMethod>(*this);
  }

  [[nodiscard]] std::shared_ptr<const MotionPreparation> prepare(
      const Frame& frame, std::span<const std::shared_ptr<const MotionPreparation>>, int) const override {
    auto preparation = std::make_shared<Preparation>();
    preparation->view = view_of(frame);
    preparation->superpixels = make_superpixels(*preparation->view, config_);
    return preparation;
  }

  [[nodiscard]] cv::Mat prior_mask(const MotionInput& input) const override {
    if (past_.empty() || !remembers_motion()) return {};
    const MotionPrior before{past_.back().view, log_odds_};
    const cv::Mat prior =
        warp_prior(*prepared(input).view, before, last_from(*input.camera_from_world), config_).log_odds;
    return enlarged(prior > config_.moving_log_odds, config_.factor, input.frame.gray.size());
  }

  [[nodiscard]] MotionResult detect(const MotionInput& input) const override {
    const Preparation& ready = prepared(input);
    const Pose& pose = *input.camera_from_world;
    std::optional<MotionPrior> prior;
    if (!past_.empty()) prior = MotionPrior{past_.back().view, log_odds_};
    auto trace = std::make_shared<StillpointMotionTrace>();
    trace->view = ready.view;
    trace->judged =
        detect_depth_motion(*ready.view, ready.superpixels, input.frame.depth,
                            references(input.frame.index, pose), prior ? &*prior : nullptr,
                            past_.empty() ? Pose::Identity() : last_from(pose), config_, input.threads);
    MotionResult result;
    result.mask = trace->judged.mask;
    result.mask_share = trace->judged.mask_share;
    result.log_odds = trace->judged.log_odds;
    result.note = trace->judged.note;
    result.trace = std::move(trace);
    return result;
  }

  void commit(const MotionInput& input, const MotionResult& result, const MotionOutcome& outcome) override {
    if (!outcome.estimated) return;
    const std::shared_ptr<const RgbdView>& view = prepared(input).view;
    log_odds_ = result.log_odds.empty() ? cv::Mat::zeros(view->depth.size(), CV_32FC1) : result.log_odds;
    past_.push_back({input.frame.index, view, std::make_shared<const Pose>(outcome.camera_from_world)});
    while (past_.size() > 1 && past_[1].frame_index <= input.frame.index - farthest_reference(config_))
      past_.erase(past_.begin());
  }

  [[nodiscard]] bool settled() const override {
    return static_cast<int>(past_.size()) > config_.far_reference;
  }

  [[nodiscard]] int frames_back() const override { return farthest_reference(config_); }

  void drop_images() override {
    for (PastView& past : past_) past.view.reset();
    if (log_odds_.empty() || !log_odds_.isContinuous()) return;
    dropped_size_ = log_odds_.size();
    dropped_ = store_of_dropped()->put(log_odds_.data, log_odds_.total() * log_odds_.elemSize());
    log_odds_.release();
  }

  [[nodiscard]] std::set<int> images_wanted(int first, int last) const override {
    std::set<int> frames;
    if (past_.empty()) return frames;
    frames.insert(past_.back().frame_index);  // the prior lies in its pixels
    for (int index = first; index <= last && index - past_.back().frame_index <= frames_back(); ++index)
      for (const int gap : reference_gaps(config_, index)) frames.insert(reference(index, gap).frame_index);
    std::erase_if(frames, [this](int frame) {
      return std::any_of(past_.begin(), past_.end(), [frame](const PastView& past) {
        return past.frame_index == frame && past.view != nullptr;
      });
    });
    return frames;
  }

  void restore_images(int first, int last, const ReadFrame& read) override {
    if (dropped_.size() > 0) {
      log_odds_.create(dropped_size_, CV_32FC1);
      dropped_.read(log_odds_.data);
      dropped_ = {};
    }
    const std::set<int> wanted = images_wanted(first, last);
    for (PastView& past : past_)
      if (wanted.contains(past.frame_index)) past.view = view_of(read(past.frame_index));
  }

  [[nodiscard]] std::unique_ptr<MotionMethod> with_config(const Config& config) const override {
    const auto& other = config.of<StillpointConfig>();
    if (other.factor != config_.factor || farthest_reference(other) > farthest_reference(config_))
      return nullptr;
    auto method = std::make_unique<StillpointMethod>(*this);
    method->config_ = other;
    return method;
  }

  [[nodiscard]] StageLog describe(const Frame& frame, const MotionResult& result) const override {
    if (result.trace)
      return describe_stillpoint(frame, static_cast<const StillpointMotionTrace&>(*result.trace), config_);
    StageLog log;
    log.note = result.note;
    return log;
  }

 private:
  [[nodiscard]] std::shared_ptr<const RgbdView> view_of(const Frame& frame) const {
    return std::make_shared<const RgbdView>(make_rgbd_view(frame.gray, frame.depth, camera_, config_.factor));
  }

  /// Whether the prior alone makes any pixel dynamic: warped, none moves more.
  [[nodiscard]] bool remembers_motion() const {
    double most = 0.0;
    cv::minMaxLoc(log_odds_, nullptr, &most);
    return most > config_.moving_log_odds;
  }

  [[nodiscard]] Pose last_from(const Pose& camera_from_world) const {
    return *past_.back().camera_from_world * camera_from_world.inverse();
  }

  /// The youngest past view that lies `gap` frames back or more, else the oldest there is.
  [[nodiscard]] const PastView& reference(int frame_index, int gap) const {
    const auto it = std::find_if(past_.rbegin(), past_.rend(),
                                 [&](const PastView& past) { return past.frame_index <= frame_index - gap; });
    return it != past_.rend() ? *it : past_.front();
  }

  [[nodiscard]] std::vector<ReferenceView> references(int frame_index, const Pose& camera_from_world) const {
    constexpr int kOld = 8;  // frames: from here on slow objects have gone somewhere
    std::vector<ReferenceView> views;
    const PastView* taken = nullptr;
    for (const int gap : reference_gaps(config_, frame_index)) {
      if (past_.empty()) break;
      const PastView& past = reference(frame_index, gap);
      if (&past == taken) continue;
      taken = &past;
      const int back = frame_index - past.frame_index;
      views.push_back({past.view, *past.camera_from_world * camera_from_world.inverse(), back >= kOld, back});
    }
    return views;
  }

  Camera camera_;
  StillpointConfig config_;
  std::vector<PastView> past_;  // newest last
  cv::Mat log_odds_;            // CV_32FC1, in the newest past view's pixels
  StoredBytes dropped_;         // … while they are dropped with the images
  cv::Size dropped_size_;
};

}  // namespace

MethodInfo stillpoint_method() {
  MethodInfo info;
  info.name = "stillpoint";
  info.title = "Stillpoint";
  info.summary =
      "Depth and brightness against two earlier frames, superpixel by superpixel, with a recursive prior.";
  info.needs.depth = info.needs.first_pose = info.needs.keeps_state = true;
  info.needs.checkpoint_every = 1;
  info.usual = info.extends_odometry = true;
  info.without_depth = "epipolar";
  info.parameters = AnySection(StillpointConfig());
  info.old_section = "depth_motion";
  info.ingredients = {
      {"depth_evidence", "judging motion by depth", {"stillpoint.use_depth=false"}},
      {"brightness_evidence", "judging motion by brightness", {"stillpoint.use_brightness=false"}},
      {"prior", "warping evidence from frame to frame", {"stillpoint.prior_share=0"}},
      {"hysteresis", "letting go only slowly of what is confidently dynamic", {"stillpoint.hysteresis=1"}},
      {"registration_error",
       "leave for surfaces that lie beside their place",
       {"stillpoint.max_registration_error_px=0"}},
      {"superpixel_shifts",
       "slow dynamic objects by the shifts of superpixels",
       {"stillpoint.superpixel_share=0"}},
      {"axial_motion",
       "superpixels that go back, away from the camera",
       {"stillpoint.find_axial_motion=false"}},
      {"label_propagation",
       "what comes into view taking over what its surface is known to do",
       {"stillpoint.label_propagation=false"}},
      {"slow_reference",
       "a far reference that lies farther back in every second frame",
       {"stillpoint.slow_reference=10"}},
      {"neighbours", "superpixels of one surface agreeing", {"stillpoint.smoothing=0"}}};
  info.make = [](const Camera& camera, const Config& config) -> std::unique_ptr<MotionMethod> {
    return std::make_unique<StillpointMethod>(camera, config.of<StillpointConfig>());
  };
  return info;
}

}  // namespace stillpoint
