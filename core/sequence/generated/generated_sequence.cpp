#include "core/sequence/generated/generated_sequence.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <mutex>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "core/error.hpp"
#include "core/geometry/pixel_conventions.hpp"
#include "core/sequence/generated/act.hpp"
#include "core/sequence/generated/ray_caster.hpp"
#include "core/sequence/generated/sensor.hpp"
#include "core/sequence/stereo/stereo_matcher.hpp"

namespace stillpoint {
namespace {

using namespace generated;

// Frames: 10 s unless asked for, and at most 55 minutes, for more is a slip of the keyboard.
constexpr int kOwnLength = 300, kMostFrames = 100000;
constexpr double kFrameRate = 30.0, kTruthRate = 100.0;  // Hz: a Kinect's, and TUM's motion capture's
constexpr double kBaseline = 0.12;                       // m, of the stereo pair
constexpr double kMostBlur = 24.0;                       // px, that four instants of an exposure stand for
constexpr double kEpoch = 1000.0;                        // s, the first frame's stamp

/// Stamps are whole microseconds, so that six decimals in a file give them back exactly.
double microseconds(double seconds) { return std::round(seconds * 1e6) / 1e6; }

class GeneratedSequence : public FrameSource, public FilmedScene {
 public:
  /// @param stereo null: depth is a sensor's own
  GeneratedSequence(std::string_view kind, std::string_view endings, int frames, unsigned seed,
                    const SensorTiming& timing, const StereoOptions* stereo)
      : name_(fmt::format("generated:{}{}", kind, endings)),
        camera_(camera_by_name("generated")),
        frames_(frames),
        act_(make_act(kind, seed, frames / kFrameRate)),
        motion_(act_.camera, seed),
        sensor_(seed),
        right_sensor_(hash(seed, 0x51DEu)) {
    camera_.readout_s = timing.readout_s;
    camera_.depth_readout_s = timing.depth_readout_s;
    camera_.depth_delay_s = timing.depth_delay_s;
    if (timing.exposure_s) act_.exposure = *timing.exposure_s;
    filming_ = camera_;
    if (stereo != nullptr) {
      camera_.baseline_m = kBaseline;
      matcher_ = std::make_unique<const StereoMatcher>(camera_, *stereo);
      camera_ = matcher_->camera();
    }
    const int poses = static_cast<int>(std::ceil(frames / kFrameRate * kTruthRate)) + 5;
    for (int i = -5; i < poses; ++i) {
      const double stamp = microseconds(kEpoch + i / kTruthRate);
      ground_truth_.push_back({stamp, motion_.world_from_camera(stamp - kEpoch)});
    }
  }

  [[nodiscard]] const std::string& name() const override { return name_; }
  [[nodiscard]] const Camera& camera() const override { return camera_; }
  [[nodiscard]] int size() const override { return frames_; }
  [[nodiscard]] double timestamp(int index) const override {
    return microseconds(kEpoch + index / kFrameRate);
  }
  [[nodiscard]] const Trajectory& ground_truth() const override { return ground_truth_; }
  [[nodiscard]] bool has_depth() const override { return true; }
  [[nodiscard]] bool has_masks() const override { return true; }
  [[nodiscard]] const std::vector<std::string>& warnings() const override { return warnings_; }

  [[nodiscard]] Frame read(int index) const override {
    const double seconds = timestamp(index) - kEpoch;
    const Rendering ideal = film_colour(seconds, 0.0);
    keep(index, ideal);

    Frame frame;
    frame.index = index;
    frame.timestamp = timestamp(index);
    frame.depth_timestamp = frame.timestamp;
    frame.colour = sensor_.colour(ideal.colour, index, seconds);
    cv::cvtColor(frame.colour, frame.gray, cv::COLOR_BGR2GRAY);
    if (matcher_) {
      const Rendering right = film_colour(seconds, kBaseline);
      matcher_->match(frame, right_sensor_.colour(right.colour, index, seconds));
      return frame;
    }
    const Rendering measured = filming_.depth_is_late(0.0) ? film_depth(seconds) : ideal;
    sensor_.depth(measured, dropout(instant(seconds)), camera_, index)
        .convertTo(frame.depth, CV_32F, 1.0 / camera_.depth_scale);
    return frame;
  }

  [[nodiscard]] FrameTruth truth(int index) const override {
    const Instant middle = instant(timestamp(index) - kEpoch);
    Rendering ideal = kept(index);
    if (ideal.depth.empty())
      ideal = film(filming_.readout_s, 0, [&](const Camera& camera, double row) {
        return cast_depth(act_.scene, camera, instant(timestamp(index) - kEpoch + filming_.row_time(row)));
      });
    FrameTruth truth;
    truth.world_from_camera = middle.world_from_camera;
    truth.depth = ideal.depth;
    truth.moving.create(ideal.id.size(), CV_8UC1);
    const std::size_t fixed = act_.scene.fixed.size();
    for (int y = 0; y < ideal.id.rows; ++y)
      for (int x = 0; x < ideal.id.cols; ++x) {
        const std::size_t id = ideal.id.at<std::uint16_t>(y, x);
        truth.moving.at<std::uint8_t>(y, x) = id >= fixed && middle.actors[id - fixed].moving ? 255 : 0;
      }
    return truth;
  }

  /// Tells these times in place of the true ones.
  void pretend(const Camera& timing_of) {
    camera_.readout_s = timing_of.readout_s;
    camera_.depth_readout_s = timing_of.depth_readout_s;
    camera_.depth_delay_s = timing_of.depth_delay_s;
  }

  [[nodiscard]] cv::Mat depth_seen_by(const DepthCamera& depth, int index) const override {
    const double seconds = timestamp(index) - kEpoch;
    Instant there = instant(seconds);
    there.world_from_camera = there.world_from_camera * depth.colour_from_depth;
    const Rendering ideal = cast_depth(act_.scene, depth.camera, there);
    cv::Mat metres;
    sensor_.depth(ideal, dropout(there), depth.camera, index)
        .convertTo(metres, CV_32F, 1.0 / depth.camera.depth_scale);
    return metres;
  }

 private:
  /// What a sensor sees whose rows are taken one after the other: bands of the image, each by itself.
  /// @param readout_s of its rows; 0: all are taken at once, as the middle one
  /// @param beyond rows above and below a band that its own ones ask for
  /// @param look what a camera sees whose image is a band, and whose middle row is that row of the whole one
  template <typename Look>
  [[nodiscard]] Rendering film(double readout_s, int beyond, const Look& look) const {
    if (readout_s == 0.0) return look(filming_, filming_.middle_row());
    constexpr int kBand = 8;  // rows: at 30 ms for an image half a band is 0.25 ms
    Rendering whole;
    for (int top = 0; top < filming_.height; top += kBand) {
      const int rows = std::min(kBand, filming_.height - top);
      Camera band = filming_;
      band.height = rows + 2 * beyond;
      band.cy -= top - beyond;
      const Rendering seen = look(band, to_pixel(RasterCoordinate(top + 0.5 * rows)));
      const auto put = [&](const cv::Mat& from, cv::Mat& to) {
        if (from.empty()) return;
        if (to.empty()) to.create(filming_.height, filming_.width, from.type());
        from.rowRange(beyond, beyond + rows).copyTo(to.rowRange(top, top + rows));
      };
      put(seen.colour, whole.colour);
      put(seen.depth, whole.depth);
      put(seen.id, whole.id);
    }
    return whole;
  }
  /// What moves into a band while it is exposed; half as much again, for the bands in which it moves faster.
  [[nodiscard]] int rows_about(double seconds) const {
    const double blurred =
        1.5 * blur(instant(seconds - 0.5 * act_.exposure), instant(seconds + 0.5 * act_.exposure));
    return static_cast<int>(std::ceil(0.5 * std::min(kMostBlur, blurred))) + 2;
  }
  [[nodiscard]] Rendering film_colour(double seconds, double aside) const {
    const int beyond = filming_.readout_s == 0.0 ? 0 : rows_about(seconds);
    return film(filming_.readout_s, beyond, [&](const Camera& camera, double row) {
      const double now = seconds + filming_.row_time(row);
      return expose(camera, now, instant(now, aside), aside);
    });
  }
  [[nodiscard]] Rendering film_depth(double seconds) const {
    return film(filming_.depth_readout_s.value_or(filming_.readout_s), 0,
                [&](const Camera& camera, double row) {
                  const double now = seconds + filming_.row_time(row) + filming_.depth_lag(0.0, row);
                  return cast_depth(act_.scene, camera, instant(now));
                });
  }

  /// What the camera sees while it exposes. Four instants do for a little blur; more is made of whole images.
  /// @param aside m, to the right of the sequence's camera
  [[nodiscard]] Rendering expose(const Camera& camera, double seconds, const Instant& middle,
                                 double aside) const {
    constexpr double kStep = 1.5;  // px between instants: closer than what the eye tells from a smear
    const auto at = [&](int k, int count) {
      return instant(seconds + act_.exposure * (k - 0.5 * (count - 1)) / count, aside);
    };
    const std::array<Instant, 4> few = {at(0, 4), at(1, 4), at(2, 4), at(3, 4)};
    const double blurred = blur(few.front(), few.back());
    if (blurred <= kMostBlur || act_.camera.handling != Handling::kShaken)
      return cast_frame(act_.scene, camera, middle, few, std::min(kMostBlur, blurred));
    const int count = std::min(40, static_cast<int>(std::ceil(4.0 / 3.0 * blurred / kStep)));
    Rendering whole = cast_depth(act_.scene, camera, middle);
    whole.colour = cv::Mat::zeros(whole.depth.size(), CV_32FC3);
    for (int k = 0; k < count; ++k) {
      const Instant one = at(k, count);
      whole.colour += cast_frame(act_.scene, camera, one, {&one, 1}, 1.0).colour / count;
    }
    return whole;
  }

  /// A frame's depth and ids, for its truth, which is mostly asked for next. Empty where others came between.
  [[nodiscard]] Rendering kept(int index) const {
    const std::lock_guard lock(mutex_);
    const auto& [whose, ideal] = kept_[static_cast<std::size_t>(index) % kept_.size()];
    return whose == index ? ideal : Rendering();
  }
  void keep(int index, const Rendering& ideal) const {
    const std::lock_guard lock(mutex_);
    kept_[static_cast<std::size_t>(index) % kept_.size()] = {index, {{}, ideal.depth, ideal.id}};
  }

  [[nodiscard]] Instant instant(double seconds, double aside = 0.0) const {
    Instant result;
    result.world_from_camera = motion_.world_from_camera(seconds);
    if (aside != 0.0) result.world_from_camera.translate(Eigen::Vector3d(aside, 0.0, 0.0));
    act_.play(seconds, result);
    return result;
  }

  [[nodiscard]] std::vector<float> dropout(const Instant& middle) const {
    std::vector<float> shares;
    for (const Primitive& p : act_.scene.fixed) shares.push_back(p.dropout);
    for (const Primitive& p : middle.actors) shares.push_back(p.dropout);
    return shares;
  }

  /// How far, in px, anything can move in the image between two instants.
  [[nodiscard]] double blur(const Instant& first, const Instant& last) const {
    constexpr double kNearest = 0.7;  // m; nothing fixed is nearer
    const Pose moved = first.world_from_camera.inverse() * last.world_from_camera;
    const double camera_blur =
        camera_.fx * (1.4 * rotation_angle(moved.linear()) + moved.translation().norm() / kNearest);
    double fastest = 0;
    for (std::size_t i = 0; i < first.actors.size(); ++i) {
      const Eigen::Vector3d a = first.actors[i].centre.cast<double>(),
                            b = last.actors[i].centre.cast<double>();
      const double distance = std::max(0.4, (a - first.world_from_camera.translation()).norm());
      fastest = std::max(fastest, camera_.fx * (b - a).norm() / distance);
    }
    return camera_blur + 1.3 * fastest;
  }

  std::string name_;
  Camera camera_;   // as it is told
  Camera filming_;  // as it is
  int frames_;
  Act act_;
  CameraMotion motion_;
  Sensor sensor_, right_sensor_;
  std::unique_ptr<const StereoMatcher> matcher_;  // null: depth is a sensor's own
  Trajectory ground_truth_;
  std::vector<std::string> warnings_;
  mutable std::mutex mutex_;
  mutable std::array<std::pair<int, Rendering>, 8> kept_;  // frames and their depth and ids, none at first
};

}  // namespace

namespace {

/// @param endings ":readout_s=0.02:…", or nothing
/// @throws InputError for a name or a number that is none
SensorTiming timing_from(std::string_view endings) {
  // An image is read out within its 33 ms: far more is an error of units.
  constexpr double kLongest = 0.1;  // s
  SensorTiming timing;
  while (!endings.empty()) {
    endings.remove_prefix(1);
    const std::string_view ending = endings.substr(0, endings.find(':'));
    endings.remove_prefix(ending.size());
    if (ending == "stereo")
      throw InputError("generated sequences are KIND:stereo, or KIND with times, and not both");
    const std::size_t equals = std::min(ending.find('='), ending.size());
    const std::string_view name = ending.substr(0, equals);
    const std::string number(ending.substr(std::min(equals + 1, ending.size())));
    char* end = nullptr;
    const double seconds = std::strtod(number.c_str(), &end);
    const bool known =
        name == "readout_s" || name == "depth_readout_s" || name == "depth_delay_s" || name == "exposure_s";
    if (!known || number.empty() || *end != '\0' || !(std::abs(seconds) <= kLongest) ||
        (name == "exposure_s" && seconds <= 0))
      throw InputError(fmt::format(
          "generated sequences are KIND, KIND:stereo, or KIND with :readout_s=, :depth_readout_s=, "
          ":depth_delay_s= or :exposure_s= and a number of seconds up to {:g}, not ':{}'",
          kLongest, ending));
    if (name == "readout_s") timing.readout_s = seconds;
    if (name == "depth_readout_s") timing.depth_readout_s = seconds;
    if (name == "depth_delay_s") timing.depth_delay_s = seconds;
    if (name == "exposure_s") timing.exposure_s = seconds;
  }
  return timing;
}

}  // namespace

const std::vector<std::string>& generated_kinds() { return act_kinds(); }
const std::vector<std::string>& hard_generated_kinds() { return hard_act_kinds(); }

std::unique_ptr<FrameSource> make_generated_sequence(std::string_view kind, int frames, unsigned seed,
                                                     const StereoOptions& stereo,
                                                     const std::optional<Camera>& timing_of) {
  if (frames < 0 || frames > kMostFrames)
    throw InputError(fmt::format(
        "{} frames cannot be generated: the number goes from 1 to {}, or 0 for the kind's own length", frames,
        kMostFrames));
  const std::string_view endings = kind.substr(std::min(kind.find(':'), kind.size()));
  kind.remove_suffix(endings.size());
  const bool is_stereo = endings == kStereoEnding;
  auto sequence = std::make_unique<GeneratedSequence>(kind, endings, frames == 0 ? kOwnLength : frames, seed,
                                                      is_stereo ? SensorTiming() : timing_from(endings),
                                                      is_stereo ? &stereo : nullptr);
  if (timing_of && !is_stereo) sequence->pretend(*timing_of);
  return sequence;
}

}  // namespace stillpoint
