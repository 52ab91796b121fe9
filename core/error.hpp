#pragma once

#include <stdexcept>
#include <string>

namespace stillpoint {

/// Bad input, told in one clear sentence: which file, which line, what was found and what was expected.
///
/// Thrown where the fault is known and reported once, by the program's top level, which then ends with a
/// non-zero status. What goes wrong in the middle of a sequence is not thrown: the frame is marked
/// (Frame::problem) and the run goes on.
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace stillpoint
