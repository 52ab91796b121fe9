#pragma once

#include <sys/types.h>

#include <string>
#include <vector>

namespace stillpoint::testing {

/// An X server without a screen, for as long as this lives; DISPLAY names it meanwhile.
class Xvfb {
 public:
  /// Starts one with further arguments. Check running().
  explicit Xvfb(const std::vector<std::string>& arguments = {});
  ~Xvfb();
  Xvfb(const Xvfb&) = delete;
  Xvfb& operator=(const Xvfb&) = delete;

  /// False where Xvfb is not installed or does not start.
  [[nodiscard]] bool running() const { return pid_ > 0; }

 private:
  pid_t pid_ = -1;
  std::string display_before_;
};

}  // namespace stillpoint::testing
