#include "core/sequence/bag/frame_tree.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstdlib>

#include "core/sequence/bag/bag_stamps.hpp"

namespace stillpoint {
namespace {

constexpr double kMoves = 1e-6;   // of a pose's numbers; less is what calculating leaves
constexpr double kMaxGap = 0.25;  // s, between samples of a frame that another's samples are joined with
constexpr std::size_t kMostFrames = 64;  // frames of a way to the root: one that goes in a circle ends here

}  // namespace

double seconds_of(std::int64_t nanoseconds) {
  constexpr std::int64_t kSecond = 1'000'000'000;  // ns
  const std::string digits = fmt::format("{}{}.{:09}", nanoseconds < 0 ? "-" : "",
                                         std::abs(nanoseconds / kSecond), std::abs(nanoseconds % kSecond));
  double value = 0;
  std::from_chars(digits.data(), digits.data() + digits.size(), value);
  return value;
}

void FrameTree::add(const TransformMessage& transform, std::int64_t recorded) {
  if (!transform.is_pose || transform.child.empty() || transform.child == transform.parent) return;
  Edge& edge = edges_[transform.child];
  if (edge.parent_from_child.empty()) edge.parent = transform.parent;
  if (edge.parent != transform.parent) return;
  edge.stamps.push_back(transform.stamp), edge.recorded.push_back(recorded);
  edge.parent_from_child.push_back({0.0, transform.parent_from_child});
}

void FrameTree::settle() {
  for (auto& [child, edge] : edges_) {
    Trajectory& poses = edge.parent_from_child;
    const BagStamps settled = settle_bag_stamps(std::move(edge.stamps), edge.recorded);
    edge.told = settled.told;
    for (std::size_t i = 0; i < poses.size(); ++i) poses[i].timestamp = seconds_of(settled.stamps[i]);
    std::stable_sort(poses.begin(), poses.end(),
                     [](const StampedPose& a, const StampedPose& b) { return a.timestamp < b.timestamp; });
    poses.erase(
        std::unique(poses.begin(), poses.end(),
                    [](const StampedPose& a, const StampedPose& b) { return a.timestamp == b.timestamp; }),
        poses.end());
    const Pose& first = poses.front().world_from_camera;
    edge.moves = std::any_of(poses.begin(), poses.end(), [&](const StampedPose& pose) {
      return (pose.world_from_camera.matrix() - first.matrix()).cwiseAbs().maxCoeff() > kMoves;
    });
  }
}

std::vector<std::string> FrameTree::moving() const {
  std::vector<std::string> frames;
  for (const auto& [child, edge] : edges_)
    if (edge.moves) frames.push_back(child);
  return frames;
}

std::vector<std::string> FrameTree::told_of(const std::vector<std::string>& way) const {
  std::vector<std::string> sentences;
  for (const std::string& frame : way)
    if (const auto edge = edges_.find(frame);
        edge != edges_.end() && edge->second.moves && !edge->second.told.empty())
      sentences.push_back(fmt::format("{}: {}", frame, edge->second.told));
  return sentences;
}

std::vector<std::string> FrameTree::way_up(const std::string& frame) const {
  std::vector<std::string> way = {frame};
  for (auto edge = edges_.find(frame); edge != edges_.end() && way.size() < kMostFrames;
       edge = edges_.find(way.back())) {
    if (std::find(way.begin(), way.end(), edge->second.parent) != way.end()) break;
    way.push_back(edge->second.parent);
  }
  return way;
}

Trajectory FrameTree::path_of(const std::string& frame) const {
  const std::vector<std::string> way = way_up(frame);
  const Edge* leading = nullptr;
  for (std::size_t i = 0; i + 1 < way.size(); ++i) {
    const Edge& edge = edges_.at(way[i]);
    if (edge.moves &&
        (leading == nullptr || edge.parent_from_child.size() > leading->parent_from_child.size()))
      leading = &edge;
  }
  Trajectory path;
  if (leading == nullptr) return path;
  for (const StampedPose& sample : leading->parent_from_child) {
    std::optional<Pose> top_from_frame = Pose::Identity();
    for (std::size_t i = 0; i + 1 < way.size() && top_from_frame; ++i) {
      const Edge& edge = edges_.at(way[i]);
      const auto step = &edge == leading ? std::optional<Pose>(sample.world_from_camera)
                        : edge.moves     ? interpolate(edge.parent_from_child, sample.timestamp, kMaxGap)
                                     : std::optional<Pose>(edge.parent_from_child.front().world_from_camera);
      if (step)
        top_from_frame = *step * *top_from_frame;
      else
        top_from_frame.reset();
    }
    if (top_from_frame) path.push_back({sample.timestamp, *top_from_frame});
  }
  return path;
}

std::optional<Pose> FrameTree::fixed_between(const std::string& ancestor, const std::string& frame) const {
  Pose result = Pose::Identity();
  for (const std::string& child : way_up(frame)) {
    if (child == ancestor) return result;
    const auto edge = edges_.find(child);
    if (edge == edges_.end() || edge->second.moves) return std::nullopt;
    result = edge->second.parent_from_child.front().world_from_camera * result;
  }
  return std::nullopt;
}

}  // namespace stillpoint
