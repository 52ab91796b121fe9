#pragma once

#include <algorithm>
#include <cmath>

namespace stillpoint {

/// How a descent went.
struct Descent {
  bool begun = false;  ///< false: the state it was to begin from has no cost
  int tried = 0;       ///< steps
  int taken = 0;       ///< those of them that made the cost less
};

/// Levenberg and Marquardt's descent to a least sum of squares, damped by Nielsen's rule (K. Madsen, H. B.
/// Nielsen, O. Tingleff, "Methods for non-linear least squares problems", 2004, §3.2): the better the
/// equations foresaw a gain, the less the next step is damped.
///
/// A problem holds a state, and the equations about it:
///   double linearise()           makes the equations about the state; returns its cost, not finite where it
///                                has none
///   double step(double damping)  moves the state as the equations say, each parameter's own entry in H grown
///                                by `damping` times itself; returns the gain they foresee, and stays where
///                                that is not above 0
///   void undo()                  state and equations are again what they were before the step
///   bool converged(double cost, double next)  whether the step, from one cost to the next, was so small that
///                                it is the last
template <typename Problem>
Descent levenberg_marquardt(Problem& problem, int most_steps) {
  // The damping: near Gauss-Newton at first, and within what double precision adds and multiplies.
  constexpr double kFirst = 1e-4, kLeast = 1e-16, kMost = 1e32;
  constexpr double kLeastGain = 1e-3;  // of the one foreseen, for a step to be taken
  Descent descent;
  double cost = problem.linearise(), damping = kFirst, harder = 2.0;
  descent.begun = std::isfinite(cost);
  while (descent.begun && descent.tried < most_steps && damping < kMost) {
    const double foreseen = problem.step(damping);
    if (!(foreseen > 0)) break;
    ++descent.tried;
    const double next = problem.linearise(), share = (cost - next) / foreseen;
    const bool converged = problem.converged(cost, next);
    if (share > kLeastGain) {
      ++descent.taken;
      cost = next;
      damping = std::max(kLeast, damping * std::max(1.0 / 3.0, 1.0 - std::pow(2.0 * share - 1.0, 3)));
      harder = 2.0;
    } else {
      problem.undo();
      damping *= harder;
      harder *= 2.0;
    }
    if (converged) break;
  }
  return descent;
}

}  // namespace stillpoint
