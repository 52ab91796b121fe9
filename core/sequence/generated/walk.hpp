#pragma once

#include <vector>

#include "core/sequence/generated/figure.hpp"

namespace stillpoint::generated {

/// A place someone walks to, and what happens there.
struct Stop {
  Vector2d position;   ///< m
  double speed = 1.1;  ///< on the way there at a brisk pace, m/s; people stroll at three quarters of it
  double pause = 0;    ///< seconds spent there; 0 = passes through
  double heading = 0;  ///< while pausing
  bool sits = false;   ///< on a chair, while pausing
};

/// People who walk their rounds for a while and step aside for each other. Simulated once at kRate, from
/// rest.
class Walk {
 public:
  static constexpr double kRate = 120.0;  // Hz: four steps of a simulation a frame
  /// One list of stops a person, gone through again and again.
  Walk(const std::vector<std::vector<Stop>>& routes, double seconds);

  /// A person's position, heading, step and sitting at a time from 0 to `seconds`.
  [[nodiscard]] FigureState at(std::size_t person, double seconds) const;

 private:
  struct Sample {
    Vector2d position;
    double heading, phase, stride, sitting;
  };
  std::vector<std::vector<Sample>> samples_;  ///< by person
};

}  // namespace stillpoint::generated
