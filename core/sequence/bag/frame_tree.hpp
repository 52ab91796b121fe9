#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/geometry/trajectory.hpp"
#include "core/sequence/bag/messages.hpp"

namespace stillpoint {

/// The frames of tf: each knows where it is in its parent, over time or once for all.
class FrameTree {
 public:
  /// Takes a transform in; one that is no pose, or that makes a frame its own parent, is passed over.
  void add(const TransformMessage& transform);
  /// Puts what was added in order of time. Once, before anything is asked.
  void settle();

  [[nodiscard]] bool knows(const std::string& frame) const { return edges_.contains(frame); }
  /// From a frame up to where no parent is known: the frame itself is first. Ends before a loop closes.
  [[nodiscard]] std::vector<std::string> way_up(const std::string& frame) const;
  /// Where a frame is in the one its way up ends at, whenever the frame that moves most often was seen. Empty
  /// where nothing on the way moves.
  [[nodiscard]] Trajectory path_of(const std::string& frame) const;
  /// Where `frame` is in `ancestor`, when nothing between them moves.
  [[nodiscard]] std::optional<Pose> fixed_between(const std::string& ancestor,
                                                  const std::string& frame) const;

 private:
  struct Edge {
    std::string parent;
    Trajectory parent_from_child;
    bool moves = false;
  };
  std::map<std::string, Edge> edges_;  ///< by child
};

/// ns as s, rounded once: the number that the decimal digits would be read as.
[[nodiscard]] double seconds_of(std::int64_t nanoseconds);

}  // namespace stillpoint
