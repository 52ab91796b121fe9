#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "ui/session/shown_runs.hpp"
#include "ui/shell/canvas.hpp"
#include "ui/workbench/layout.hpp"

namespace stillpoint {

/// A second run that stood beside a sequence's.
struct KeptGhost {
  std::string name;
  std::vector<std::string> settings;  ///< constants other than the defaults
  int from = 0;                       ///< frame it branched off at
  bool operator==(const KeptGhost&) const = default;
};

/// A sequence as it was left: opened again, it is the same experiment.
struct RecentSequence {
  std::string where;
  std::vector<std::string> reading;   ///< how it was read, "camera=freiburg1", "run=NAME=FILE", …
  std::vector<std::string> settings;  ///< constants other than the defaults, "run.method=paper", …
  int frame = 1;                      ///< the one shown last
  std::vector<KeptGhost>
      ghosts{};      ///< runs beside it, but for other programs', which are a matter of reading
  RunsShown runs{};  ///< which of them pictures show
  bool operator==(const RecentSequence&) const = default;
};

/// What the window remembers from one time to the next.
struct Settings {
  Look look{};
  std::optional<LayoutNode> layout;
  std::vector<RecentSequence> recent;  ///< newest first
  std::optional<std::array<int, 2>>
      window_size{};  ///< screen coordinates; nothing before the first window closed
};

inline constexpr std::size_t kRecentKept = 8;  // sequences, which the start page lists

/// `settings.json` in $XDG_CONFIG_HOME/stillpoint, or in ~/.config/stillpoint; empty where neither is known.
[[nodiscard]] std::filesystem::path settings_path();

/// The settings a file holds. A file that is not there gives the defaults; one that cannot be used does too,
/// and says why.
/// @param known names of the panels there are
[[nodiscard]] Settings read_settings(const std::filesystem::path& path, const std::vector<std::string>& known,
                                     std::string* problem = nullptr);

/// @throws InputError when it cannot be written
void write_settings(const std::filesystem::path& path, const Settings& settings);

/// Puts a sequence in front of those opened before, in place of what was known of it.
void remember(std::vector<RecentSequence>& recent, RecentSequence sequence);

/// Reads a whole layout file.
/// @throws InputError for a file that cannot be read or is no layout
[[nodiscard]] LayoutNode read_layout(const std::filesystem::path& path,
                                     const std::vector<std::string>& known);

}  // namespace stillpoint
