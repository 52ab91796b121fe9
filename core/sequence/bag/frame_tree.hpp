#pragma once

#include <cstdint>
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
  /// @param recorded ns, when its message was
  void add(const TransformMessage& transform, std::int64_t recorded);
  /// Puts what was added in order of time, by stamps that are settled as those of topics are
  /// (bag_stamps.hpp). Once, before anything is asked.
  void settle();

  [[nodiscard]] bool knows(const std::string& frame) const { return edges_.contains(frame); }
  /// Frames that move in their parents, by name.
  [[nodiscard]] std::vector<std::string> moving() const;
  /// What was wrong with the stamps of the frames of a way up, a sentence each that begins with the frame.
  [[nodiscard]] std::vector<std::string> told_of(const std::vector<std::string>& way) const;
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
    std::vector<std::int64_t> stamps, recorded;  ///< ns, of parent_from_child until it is settled
    Trajectory parent_from_child;
    bool moves = false;
    std::string told;  ///< of its stamps
  };
  std::map<std::string, Edge> edges_;  ///< by child
};

/// ns as s, rounded once: the number that the decimal digits would be read as.
[[nodiscard]] double seconds_of(std::int64_t nanoseconds);

}  // namespace stillpoint
