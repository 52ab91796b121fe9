#include "core/sequence/bag/bag_truth.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <initializer_list>
#include <iterator>
#include <set>

#include "core/sequence/bag/bag_stamps.hpp"
#include "core/sequence/bag/frame_tree.hpp"
#include "core/text_file.hpp"

namespace stillpoint {
namespace {

bool names_truth(const std::string& topic) {
  return has_any(topic, {"ground", "truth", "vicon", "mocap", "optitrack", "qualisys", "vrpn", "/gt", "_gt"});
}

bool names_world(const std::string& frame) {
  return has_any(frame, {"world", "ground", "truth", "vicon", "mocap", "optitrack", "qualisys", "vrpn"});
}

/// Words of which any may stand in the name of what a motion capture tracks, when that is the camera.
constexpr const char* kCameraWords[] = {"camera", "cam",  "kinect", "xtion",   "realsense",
                                        "zed",    "rgbd", "color",  "optical", "sensor"};

/// The words of three letters and more of a name, in small letters, without numbers: of /mocap/Camera_1/pose,
/// camera, mocap and pose.
std::set<std::string> words_of(const std::string& name) {
  constexpr std::size_t kShortest = 3;  // letters
  static const std::set<std::string> kNotOfOne = {"image", "pose", "frame", "link", "raw"};
  std::set<std::string> words;
  std::string word;
  for (const char letter : lower_case(name) + "/") {
    if (letter >= 'a' && letter <= 'z') {
      word += letter;
      continue;
    }
    if (word.size() >= kShortest && !kNotOfOne.contains(word)) words.insert(word);
    word.clear();
  }
  return words;
}

std::string shortened(std::vector<std::string> names) {
  constexpr std::size_t kMost = 6;  // names: a hint, and no listing
  if (names.size() > kMost) names.resize(kMost), names.emplace_back("…");
  return fmt::format("{}", fmt::join(names, ", "));
}

class Reader {
 public:
  Reader(const MessageLog& log, const TopicChoice& choice, const std::string& camera)
      : log_(log), camera_(camera), colour_(choice.colour.topic) {
    for (std::size_t i = 0; i < log.topics().size(); ++i) {
      if (!is_tf_type(log.topics()[i].type)) continue;
      if (!tf_) tf_ = i;
      read(i, [this](const TransformMessage& transform, std::int64_t recorded) {
        tree_.add(transform, recorded);
      });
    }
    tree_.settle();
    if (choice.no_truth) return;
    if (choice.truth && is_tf_type(log.topics()[*choice.truth].type))
      take_tf(*choice.truth, true);
    else if (choice.truth)
      take_poses(*choice.truth);
    else
      find();
  }

  [[nodiscard]] BagTruth take() {
    if (unreadable_ > 0)
      truth_.warnings.push_back(fmt::format("{}: {} messages of poses cannot be read and were passed over",
                                            log_.path(), unreadable_));
    return std::move(truth_);
  }

 private:
  template <typename Take>
  void read(std::size_t topic, const Take& take) {
    const LoggedTopic& logged = log_.topics()[topic];
    for (std::size_t i = 0; i < logged.times.size(); ++i) {
      try {
        for (const TransformMessage& transform :
             transform_messages(log_.read(topic, i), logged.format, logged.type))
          take(transform, logged.times[i]);
      } catch (const MalformedBytes&) {
        ++unreadable_;
      }
    }
  }

  /// A topic that its name calls truth.
  struct Named {
    std::size_t topic = 0;
    bool is_joined = false;  ///< tf says where its body is on the camera
    int words = 0;           ///< that speak of the camera
  };

  void find() {
    if (tf_) take_tf(*tf_, false);
    std::vector<Named> named;
    std::vector<std::size_t> others;
    for (std::size_t i = 0; i < log_.topics().size() && truth_.poses.empty(); ++i) {
      const LoggedTopic& topic = log_.topics()[i];
      if (!is_pose_type(topic.type) || topic.times.empty() || topic.format == WireFormat::other) continue;
      if (names_truth(topic.name))
        named.push_back(look_at(i));
      else
        others.push_back(i);
    }
    std::stable_sort(named.begin(), named.end(), [](const Named& a, const Named& b) {
      return a.is_joined != b.is_joined ? a.is_joined : a.words > b.words;
    });
    for (std::size_t i = 0; i < named.size() && truth_.poses.empty(); ++i) take_poses(named[i].topic);
    if (truth_.poses.empty())
      tell_not_taken(others);
    else
      tell_choice(named);
  }

  [[nodiscard]] Named look_at(std::size_t topic) const {
    const LoggedTopic& logged = log_.topics()[topic];
    Named named;
    named.topic = topic;
    std::string body;
    for (std::size_t i = 0; i < std::min(logged.times.size(), kFirstMessages); ++i) {
      try {
        body = transform_messages(log_.read(topic, i), logged.format, logged.type).front().child;
        break;
      } catch (const MalformedBytes&) {  // the next may tell
      }
    }
    named.is_joined = !body.empty() && (body == camera_ || tree_.fixed_between(body, camera_));
    std::set<std::string> cameras = words_of(camera_ + "/" + log_.topics()[colour_].name);
    cameras.insert(std::begin(kCameraWords), std::end(kCameraWords));
    for (const std::string& word : words_of(logged.name + "/" + body))
      named.words += cameras.contains(word) ? 1 : 0;
    return named;
  }

  /// @param named the one that is likeliest of the camera first
  void tell_choice(const std::vector<Named>& named) {
    if (named.size() < 2 || (named[0].is_joined && !named[1].is_joined)) return;
    std::vector<std::string> names;
    for (const Named& topic : named) names.push_back(log_.topics()[topic.topic].name);
    truth_.warnings.push_back(
        fmt::format("{}: {} topics may be the camera's ground truth, {}; {} was taken (`--topics "
                    "truth=TOPIC` takes another)",
                    log_.path(), names.size(), shortened(names), log_.topics()[*truth_.topic].name));
  }

  /// @param others topics of poses that no name calls truth
  void tell_not_taken(const std::vector<std::size_t>& others) {
    if (!truth_.why_not.empty()) return;
    if (!others.empty()) {
      std::vector<std::string> names;
      for (const std::size_t topic : others)
        names.push_back(fmt::format("{} ({})", log_.topics()[topic].name, log_.topics()[topic].type));
      const bool is_one = names.size() == 1;
      truth_.why_not = fmt::format(
          "{}: {} may be {} and {} not taken for ground truth (`--topics truth={}` takes {})", log_.path(),
          shortened(names), is_one ? "an estimate" : "estimates", is_one ? "was" : "were",
          log_.topics()[others.front()].name, is_one ? "it" : "the first");
      return;
    }
    for (const std::string& frame : tree_.moving()) {
      const std::vector<std::string> way = tree_.way_up(frame);
      if (!names_world(way.back()) && !has_any(way.back(), {"map", "odom"})) continue;
      truth_.why_not = fmt::format(
          "{}:{}: has the way of {} in {}, to which the colour images' frame, {}, is not joined; no ground "
          "truth was taken from it",
          log_.path(), log_.topics()[*tf_].name, frame, way.back(),
          camera_.empty() ? "which they do not name" : camera_);
      return;
    }
  }

  void take_tf(std::size_t topic, bool is_asked) {
    const std::vector<std::string> way = tree_.way_up(camera_);
    Trajectory poses = tree_.path_of(camera_);
    const std::string path = fmt::format("{}:{}", log_.path(), log_.topics()[topic].name);
    if (poses.empty()) {
      if (is_asked)
        truth_.why_not =
            fmt::format("{}: nothing in it moves above the colour images' frame {}", path, camera_);
      return;
    }
    const bool is_estimate = std::any_of(way.begin(), way.end(),
                                         [](const std::string& frame) { return has_any(frame, {"odom"}); }) ||
                             !names_world(way.back());
    if (is_estimate && !is_asked) {
      truth_.why_not = fmt::format(
          "{}: has the camera's way in {} ({}), which may be an estimate and was not taken "
          "for ground truth (`--topics truth={}` takes it)",
          path, way.back(), fmt::join(way, " < "), log_.topics()[topic].name);
      return;
    }
    truth_.topic = topic;
    truth_.path = path;
    truth_.poses = std::move(poses);
    truth_.why_not.clear();
    for (const std::string& sentence : tree_.told_of(way))
      truth_.warnings.push_back(fmt::format("{}: {}", path, sentence));
  }

  void take_poses(std::size_t topic) {
    const LoggedTopic& logged = log_.topics()[topic];
    Trajectory poses;
    std::string body;
    std::vector<std::int64_t> stamps, recorded;
    std::size_t no_poses = 0;
    read(topic, [&](const TransformMessage& transform, std::int64_t time) {
      if (body.empty()) body = transform.child;
      if (transform.is_pose) {
        stamps.push_back(transform.stamp), recorded.push_back(time);
        poses.push_back({0.0, transform.parent_from_child});
      } else {
        ++no_poses;
      }
    });
    truth_.topic = topic;
    truth_.path = fmt::format("{}:{}", log_.path(), logged.name);
    truth_.why_not.clear();
    const BagStamps settled = settle_bag_stamps(std::move(stamps), recorded);
    if (!settled.told.empty()) truth_.warnings.push_back(fmt::format("{}: {}", truth_.path, settled.told));
    for (std::size_t i = 0; i < poses.size(); ++i) poses[i].timestamp = seconds_of(settled.stamps[i]);
    if (no_poses > 0)
      truth_.warnings.push_back(fmt::format("{}: {} of {} messages hold no pose and were skipped",
                                            truth_.path, no_poses, no_poses + poses.size()));
    std::stable_sort(poses.begin(), poses.end(),
                     [](const StampedPose& a, const StampedPose& b) { return a.timestamp < b.timestamp; });
    const auto same = [](const StampedPose& a, const StampedPose& b) { return a.timestamp == b.timestamp; };
    const std::size_t before = poses.size();
    poses.erase(std::unique(poses.begin(), poses.end(), same), poses.end());
    if (before > poses.size())
      truth_.warnings.push_back(fmt::format("{}: {} poses repeat an earlier timestamp and were dropped",
                                            truth_.path, before - poses.size()));
    if (const auto camera =
            body.empty() || body == camera_ ? std::nullopt : tree_.fixed_between(body, camera_))
      for (StampedPose& pose : poses) pose.world_from_camera = pose.world_from_camera * *camera;
    if (poses.empty()) truth_.why_not = fmt::format("{}: holds no poses", truth_.path);
    truth_.poses = std::move(poses);
  }

  const MessageLog& log_;
  const std::string& camera_;
  std::size_t colour_;
  FrameTree tree_;
  std::optional<std::size_t> tf_;
  std::size_t unreadable_ = 0;
  BagTruth truth_;
};

}  // namespace

BagTruth read_bag_truth(const MessageLog& log, const TopicChoice& choice, const std::string& camera_frame) {
  return Reader(log, choice, camera_frame).take();
}

}  // namespace stillpoint
