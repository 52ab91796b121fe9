#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/sequence/source.hpp"

namespace stillpoint {

// What can be opened, and what is in it, before it is.

enum class PlaceKind {
  folder,    ///< to be looked into
  sequence,  ///< a folder that has images, or lists or folders of them by their usual names
  run,       ///< a finished run's folder
  file,      ///< an archive, a bag or a video
};

struct OpenPlace {
  std::string name;
  PlaceKind kind = PlaceKind::folder;
  bool operator==(const OpenPlace&) const = default;
};

/// What a path is, by a quick look; a path that is nothing of these, or not there, is no place.
[[nodiscard]] std::optional<PlaceKind> kind_of_place(const std::filesystem::path& path);

/// The places in a folder: folders first, then files, each by name as people count (frame 2 before frame 10).
/// Hidden ones and all other files are left out.
/// @throws InputError where the folder cannot be read
[[nodiscard]] std::vector<OpenPlace> places_in(const std::filesystem::path& folder);

/// A line of what a sequence is: "Depth", "at 5000 a metre".
struct SequenceFact {
  std::string name, value;
};

/// Frames, camera, depth, masks and ground truth, in this order.
[[nodiscard]] std::vector<SequenceFact> sequence_facts(const FrameSource& source);

}  // namespace stillpoint
