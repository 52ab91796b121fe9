#pragma once

#include <string>
#include <vector>

namespace stillpoint {

/// A file that is written under another name and takes its own once it is whole; else it goes away.
class McapFileName {
 public:
  /// @throws InputError where something of that name is there and `force` is not given, or its end is not
  /// .mcap
  McapFileName(std::string path, bool force);
  ~McapFileName();
  McapFileName(const McapFileName&) = delete;
  McapFileName& operator=(const McapFileName&) = delete;
  [[nodiscard]] const std::string& while_written() const { return part_; }
  /// Gives it its name, and lays Foxglove's layout beside it.
  /// @throws InputError when that cannot be
  void finish();

 private:
  std::string path_, part_;
  bool finished_ = false;
};

/// A finished run as an MCAP file. @param layers ids of stages' layers to write beside
/// @throws InputError in one sentence for what cannot be opened or written
void export_mcap(const std::string& run_folder, const std::string& sequence, const std::string& to,
                 bool force, const std::vector<std::string>& layers);

}  // namespace stillpoint
