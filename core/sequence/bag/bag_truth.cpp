#include "core/sequence/bag/bag_truth.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <initializer_list>

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

class Reader {
 public:
  Reader(const MessageLog& log, const TopicChoice& choice, const std::string& camera)
      : log_(log), camera_(camera) {
    for (std::size_t i = 0; i < log.topics().size(); ++i) {
      if (!is_tf_type(log.topics()[i].type)) continue;
      if (!tf_) tf_ = i;
      read(i, [this](const TransformMessage& transform) { tree_.add(transform); });
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
          take(transform);
      } catch (const MalformedBytes&) {
        ++unreadable_;
      }
    }
  }

  void find() {
    if (tf_) take_tf(*tf_, false);
    for (std::size_t i = 0; i < log_.topics().size() && truth_.poses.empty(); ++i)
      if (is_pose_type(log_.topics()[i].type) && names_truth(log_.topics()[i].name) &&
          !log_.topics()[i].times.empty())
        take_poses(i);
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
  }

  void take_poses(std::size_t topic) {
    const LoggedTopic& logged = log_.topics()[topic];
    Trajectory poses;
    std::string body, parent;
    std::size_t no_poses = 0;
    read(topic, [&](const TransformMessage& transform) {
      if (body.empty()) body = transform.child, parent = transform.parent;
      if (transform.is_pose)
        poses.push_back({seconds_of(transform.stamp), transform.parent_from_child});
      else
        ++no_poses;
    });
    truth_.topic = topic;
    truth_.path = fmt::format("{}:{}", log_.path(), logged.name);
    truth_.why_not.clear();
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
