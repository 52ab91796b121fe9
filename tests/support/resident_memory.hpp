#pragma once

#include <unistd.h>

#include <fstream>

namespace stillpoint {

/// Resident memory of this process, MB.
inline double resident_mb() {
  std::ifstream file("/proc/self/statm");
  double whole = 0.0, resident = 0.0;
  file >> whole >> resident;
  return resident * static_cast<double>(::sysconf(_SC_PAGESIZE)) / 1e6;
}

}  // namespace stillpoint
