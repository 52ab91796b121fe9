#pragma once

#include <string>
#include <vector>

#include "core/out_folder.hpp"

namespace stillpoint {

/// The name of an MCAP file, which it takes once it is whole.
class McapFileName {
 public:
  /// @throws InputError where something of that name is there and `force` is not given, or its end is not
  /// .mcap
  McapFileName(std::string path, bool force);
  [[nodiscard]] std::string while_written() const { return file_.while_written().string(); }
  /// Gives it its name, and lays Foxglove's layout beside it.
  /// @throws InputError when that cannot be
  void finish();

 private:
  std::string path_;
  WholeFile file_;
};

/// A finished run as an MCAP file. @param layers ids of stages' layers to write beside
/// @throws InputError in one sentence for what cannot be opened or written
void export_mcap(const std::string& run_folder, const std::string& sequence, const std::string& to,
                 bool force, const std::vector<std::string>& layers);

}  // namespace stillpoint
