#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/inspect/marks.hpp"

namespace stillpoint {

/// What a person marked in a sequence.
struct Marks {
  std::vector<Bookmark> bookmarks;
  std::vector<Pin> pins;
  std::vector<Breakpoint> breakpoints;
  std::vector<DrawnFrame> drawn;  ///< truth drawn by hand, by frame
  std::optional<FrameSpan> span;
  bool loop = false;
  bool operator==(const Marks&) const = default;
};

/// The sequence that marks belong to.
struct MarkedSequence {
  std::string name;
  std::string hash;  ///< sequence_fingerprint
  int frames = 0;
};

/// Reads a sidecar file.
/// @throws InputError in one sentence for a file that cannot be read, is damaged, is of another version, or
/// belongs to another sequence or to another state of this one
[[nodiscard]] Marks read_marks(const std::filesystem::path& file, const MarkedSequence& sequence);

/// Writes a sidecar file, whole or not at all.
/// @throws InputError when it cannot be written
void write_marks(const std::filesystem::path& file, const MarkedSequence& sequence, const Marks& marks);

/// Where sidecars may be.
struct SidecarPlaces {
  std::filesystem::path folder;       ///< of the sequence or run; empty where there is none
  std::filesystem::path user_folder;  ///< for what has no folder that can be written; empty = nowhere
};

/// The sidecar of a sequence being looked at: `stillpoint.json` in its folder, or in the user's own folder a
/// file by the sequence's hash. A file that cannot be used is left as it is, whatever is marked.
class Sidecar {
 public:
  Sidecar(const SidecarPlaces& places, MarkedSequence sequence);

  /// What was kept; nothing when nothing was.
  /// @throws InputError as read_marks does; save() then writes nothing
  [[nodiscard]] Marks load();

  /// Writes when something has changed since.
  /// @throws InputError when it cannot be written
  void save(const Marks& marks);

  [[nodiscard]] const std::filesystem::path& file() const { return file_; }  ///< empty = nothing is kept

 private:
  std::filesystem::path file_, user_file_;
  MarkedSequence sequence_;
  Marks kept_;  // as the file has them
  bool locked_ = false;
};

inline constexpr const char* kSidecarName = "stillpoint.json";

}  // namespace stillpoint
