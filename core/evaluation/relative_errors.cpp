// Relative pose errors: what is wrong with the camera's motion from one pose to another.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <numbers>
#include <random>
#include <sstream>

#include "core/error.hpp"
#include "core/evaluation/trajectory_metrics.hpp"

namespace stillpoint {
namespace {

RelativeError relative_error(const MatchedPose& i, const MatchedPose& j) {
  const Pose truth_motion = i.truth.inverse() * j.truth;
  const Pose estimated_motion = i.estimate.inverse() * j.estimate;
  const Pose error = truth_motion.inverse() * estimated_motion;
  return {i.timestamp, j.timestamp, error.translation().norm(), to_degrees(rotation_angle(error.linear()))};
}

void summarise(RelativePoseError& result, const std::string& why_none) {
  result.errors.shrink_to_fit();  // many lists of them are held at once
  std::vector<double> translations, rotations;
  translations.reserve(result.errors.size()), rotations.reserve(result.errors.size());
  for (const RelativeError& error : result.errors) {
    translations.push_back(error.translation_m);
    rotations.push_back(error.rotation_deg);
  }
  result.translation_m = statistics_of(std::move(translations));
  result.rotation_deg = statistics_of(std::move(rotations));
  if (result.errors.empty()) result.why_none = why_none;
}

/// The truth's path up to each matched pose, m.
std::vector<double> path_of(const std::vector<MatchedPose>& matched) {
  std::vector<double> path;
  for (std::size_t i = 0; i < matched.size(); ++i)
    path.push_back(i == 0 ? 0.0
                          : path.back() +
                                (matched[i].truth.translation() - matched[i - 1].truth.translation()).norm());
  return path;
}

/// Python 2's random module from a seed of 0: the Mersenne Twister, seeded by a key of one word.
class PythonRandom {
 public:
  PythonRandom() {
    constexpr std::uint32_t kKey = 0;  // random.seed(0), as the benchmark's script has it
    std::array<std::uint32_t, 624> state{};
    state[0] = 19650218U;
    for (std::uint32_t i = 1; i < state.size(); ++i)
      state[i] = 1812433253U * (state[i - 1] ^ (state[i - 1] >> 30U)) + i;
    std::uint32_t i = 1;
    const auto next = [&] {
      if (++i < state.size()) return;
      state[0] = state[623];
      i = 1;
    };
    for (int k = 0; k < 624; ++k, next())
      state[i] = (state[i] ^ ((state[i - 1] ^ (state[i - 1] >> 30U)) * 1664525U)) + kKey;
    for (int k = 0; k < 623; ++k, next())
      state[i] = (state[i] ^ ((state[i - 1] ^ (state[i - 1] >> 30U)) * 1566083941U)) - i;
    state[0] = 0x80000000U;
    std::stringstream text;
    for (const std::uint32_t word : state) text << word << ' ';
    text << state.size();
    text >> twister_;
  }
  /// random.randint(0, count - 1)
  [[nodiscard]] std::size_t below(std::size_t count) {
    const auto high = static_cast<double>(twister_() >> 5U), low = static_cast<double>(twister_() >> 6U);
    return static_cast<std::size_t>((high * 67108864.0 + low) / 9007199254740992.0 *
                                    static_cast<double>(count));
  }

 private:
  std::mt19937 twister_;
};

/// The pose nearest in time, the earlier of two that are as near.
std::size_t closest(const Trajectory& trajectory, double timestamp) {
  const auto after = std::lower_bound(trajectory.begin(), trajectory.end(), timestamp,
                                      [](const StampedPose& pose, double t) { return pose.timestamp < t; });
  if (after == trajectory.begin()) return 0;
  const auto at = static_cast<std::size_t>(after - trajectory.begin());
  if (after == trajectory.end()) return at - 1;
  return timestamp - trajectory[at - 1].timestamp <= after->timestamp - timestamp ? at - 1 : at;
}

}  // namespace

std::string RpeDelta::text() const {
  switch (unit) {
    case Unit::seconds:
      return fmt::format("{:g} s", value);
    case Unit::frames:
      return value == 1.0 ? "1 frame" : fmt::format("{:g} frames", value);
    case Unit::metres:
      break;
  }
  return fmt::format("{:.3g} m", value);
}

RpeDelta rpe_delta_of(const std::string& text) {
  RpeDelta delta;
  const char* end = text.data() + text.size();
  const auto [rest, failed] = std::from_chars(text.data(), end, delta.value);
  const std::string unit(rest, end);
  const bool known = unit == "s" || unit == "f" || unit == "m";
  if (failed != std::errc() || !known || !std::isfinite(delta.value) || delta.value <= 0 ||
      (unit == "f" && (delta.value != std::floor(delta.value) || delta.value > 1e6)))
    throw InputError(fmt::format("'{}' is no distance of poses; write 1s, 10f (frames) or 5m", text));
  delta.unit = unit == "s"   ? RpeDelta::Unit::seconds
               : unit == "f" ? RpeDelta::Unit::frames
                             : RpeDelta::Unit::metres;
  return delta;
}

RelativePoseError relative_error_over_time(const std::vector<MatchedPose>& matched, double delta_s,
                                           double tolerance_s) {
  RelativePoseError result;
  result.delta = fmt::format("{} s", delta_s);
  result.limit_s = tolerance_s;
  for (std::size_t i = 0; i < matched.size(); ++i) {
    const double wanted = matched[i].timestamp + delta_s;
    auto j = std::lower_bound(matched.begin(), matched.end(), wanted,
                              [](const MatchedPose& pose, double t) { return pose.timestamp < t; });
    if (j == matched.end() || (j != matched.begin() && wanted - (j - 1)->timestamp <= j->timestamp - wanted))
      --j;
    if (j - matched.begin() <= static_cast<std::ptrdiff_t>(i) ||
        std::abs(j->timestamp - wanted) > tolerance_s)
      ++result.dropped;
    else
      result.errors.push_back(relative_error(matched[i], *j));
  }
  summarise(result, fmt::format("no two matched poses are {} apart", result.delta));
  return result;
}

RelativePoseError relative_error_per_frame(const std::vector<MatchedPose>& matched, double neighbour_gap) {
  RelativePoseError result;
  result.delta = "1 frame";
  std::vector<double> gaps;
  for (std::size_t i = 0; i + 1 < matched.size(); ++i)
    gaps.push_back(matched[i + 1].timestamp - matched[i].timestamp);
  result.limit_s = neighbour_gap * statistics_of(gaps).median;
  for (std::size_t i = 0; i < gaps.size(); ++i) {
    if (gaps[i] > result.limit_s)
      ++result.dropped;
    else
      result.errors.push_back(relative_error(matched[i], matched[i + 1]));
  }
  summarise(result, "no two matched poses follow one another");
  return result;
}

RelativePoseError relative_error_over_frames(const std::vector<MatchedPose>& matched, int frames) {
  RelativePoseError result;
  result.delta = RpeDelta{static_cast<double>(frames), RpeDelta::Unit::frames}.text();
  const auto step = static_cast<std::size_t>(std::max(frames, 1));
  for (std::size_t i = 0; i + step < matched.size(); ++i)
    result.errors.push_back(relative_error(matched[i], matched[i + step]));
  result.dropped = static_cast<int>(matched.size() - result.errors.size());
  summarise(result, fmt::format("no two matched poses are {} apart", result.delta));
  return result;
}

RelativePoseError relative_error_over_distance(const std::vector<MatchedPose>& matched, double metres) {
  RelativePoseError result;
  result.delta = RpeDelta{metres, RpeDelta::Unit::metres}.text();
  const std::vector<double> path = path_of(matched);
  for (std::size_t i = 0; i < matched.size(); ++i) {
    const auto end =
        std::lower_bound(path.begin() + static_cast<std::ptrdiff_t>(i), path.end(), path[i] + metres);
    if (end == path.end())
      ++result.dropped;
    else
      result.errors.push_back(
          relative_error(matched[i], matched[static_cast<std::size_t>(end - path.begin())]));
  }
  summarise(result,
            fmt::format("the truth's matched path is {:.3g} m long", path.empty() ? 0.0 : path.back()));
  return result;
}

RelativePoseError relative_error_of_random_pairs(const Trajectory& truth, const Trajectory& estimate) {
  // Below so many poses all pairs are taken, otherwise so many are drawn: as the benchmark's script has it.
  constexpr std::size_t kAllBelow = 100, kPairs = 10000;
  RelativePoseError result;
  result.delta = "random pairs";
  std::vector<MatchedPose> poses;
  for (const StampedPose& e : estimate) {
    if (truth.empty()) break;
    const StampedPose& t = truth[closest(truth, e.timestamp)];
    poses.push_back({e.timestamp, t.timestamp, e.world_from_camera, t.world_from_camera});
  }
  std::vector<double> steps;
  for (std::size_t i = 0; i + 1 < truth.size(); ++i)
    steps.push_back(truth[i + 1].timestamp - truth[i].timestamp);
  result.limit_s = 2.0 * statistics_of(steps).median;
  const auto add = [&](std::size_t i, std::size_t j) {
    const auto far = [&](const MatchedPose& p) {
      return std::abs(p.truth_timestamp - p.timestamp) > result.limit_s;
    };
    if (far(poses[i]) || far(poses[j]))
      ++result.dropped;
    else
      result.errors.push_back(
          relative_error(poses[j], poses[i]));  // the script goes from the second to the first
  };
  const std::size_t count = poses.size();
  if (count > 1 && count < kAllBelow) {
    for (std::size_t i = 0; i < count; ++i)
      for (std::size_t j = 0; j < count; ++j) add(i, j);
  } else if (count > 1) {
    PythonRandom random;
    for (std::size_t k = 0; k < kPairs; ++k) {
      const std::size_t i = random.below(count), j = random.below(count);
      add(i, j);
    }
  }
  summarise(result, "fewer than two poses have a truth close in time");
  return result;
}

std::vector<double> usual_lengths_m(const std::vector<MatchedPose>& matched) {
  const std::vector<double> path = path_of(matched);
  std::vector<double> lengths;
  for (int tenths = 1; tenths <= 5 && !path.empty() && path.back() > 0; ++tenths)
    lengths.push_back(0.1 * tenths * path.back());
  return lengths;
}

void use_protocol(Protocol protocol, EvaluationOptions& options) {
  options.protocol = protocol;
  if (protocol != Protocol::evo) return;
  options.max_difference_s = 0.01;
  options.nearest = true;
  options.align = AlignBy::nothing;
  options.neighbour_gap = std::numeric_limits<double>::infinity();
}

}  // namespace stillpoint
