#include "core/check/check_sequence.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <utility>

#include "core/config.hpp"

namespace stillpoint {
namespace {

// A few seconds of work; fewer frames where every known camera goes over them.
constexpr int kFramesTracked = 60, kFramesByCamera = 40;
// Tracked again under the times found: what was tracked under others drags them a millisecond towards those.
constexpr TimeStretch kShortStretch = {.frames = 90, .tries = 1, .runs = 2};

/// Switches that mend for certain what names them, in the order in which they are tried.
constexpr std::array<const char*, 4> kMendsForCertain = {"depth-scale", "camera", "truth", "calibrate-time"};

}  // namespace

SequenceCheck check_sequence(const FrameSource& source, const std::stop_token& stop) {
  SequenceCheck check;
  std::atomic<bool> stopped = false;
  const std::stop_callback on_stop(stop, [&stopped] { stopped = true; });
  const auto add = [&check](std::vector<Finding> found) {
    for (Finding& finding : found) check.findings.push_back(std::move(finding));
  };
  add(check_frames(source));
  // What depth of another time seems to say of its camera and its readings is its clock's doing.
  const bool in_time = !source.depth_late_s();
  if (in_time) add(check_registration(source));
  const std::size_t before = check.findings.size();
  if (in_time && !stopped) add(check_parallax(source));
  // Poses that rest on what is no depth would be blamed on scale, camera or truth.
  if (check.findings.size() > before) return check;
  if (!stopped) add(check_odometry(source, kFramesTracked, &stopped));
  if (!stopped) add(check_camera(source, kFramesByCamera, &stopped));
  if (stopped) return check;
  TimeStretch stretch = kShortStretch;
  stretch.stop = &stopped;
  check.times = calibrate_time(source, Config(), stretch);
  if (!stopped) add(check_times(check.times, source.camera()));
  return check;
}

std::string Remedy::text() const { return value.empty() ? "--" + name : "--" + name + " " + value; }

std::optional<Remedy> remedy_of(const Finding& finding) {
  constexpr std::string_view kBegin = "`--";
  const std::string& sentence = finding.sentence;
  for (auto at = sentence.find(kBegin); at != std::string::npos; at = sentence.find(kBegin, at + 1)) {
    const auto begin = at + kBegin.size(), end = sentence.find('`', begin);
    if (end == std::string::npos) return std::nullopt;
    const std::string words = sentence.substr(begin, end - begin);
    const auto space = words.find(' ');
    Remedy remedy{words.substr(0, space), space == std::string::npos ? "" : words.substr(space + 1)};
    const bool takes_value = remedy.name != kMendsForCertain.back();
    if (std::find(kMendsForCertain.begin(), kMendsForCertain.end(), remedy.name) != kMendsForCertain.end() &&
        takes_value != remedy.value.empty())
      return remedy;
  }
  return std::nullopt;
}

std::optional<std::pair<Remedy, Finding>> first_remedy(const std::vector<Finding>& findings,
                                                       const std::vector<std::string>& given) {
  for (const char* name : kMendsForCertain) {
    if (std::find(given.begin(), given.end(), name) != given.end()) continue;
    for (const Finding& finding : findings)
      if (auto remedy = remedy_of(finding); remedy && remedy->name == name)
        return std::pair(std::move(*remedy), finding);
  }
  return std::nullopt;
}

}  // namespace stillpoint
