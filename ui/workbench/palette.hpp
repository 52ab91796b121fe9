#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace stillpoint {

/// A line of the palette: something that can be done by its name.
struct PaletteRow {
  std::string icon, title;
  std::string words{};  ///< by which it is found too, though they are not shown
  std::string key{};    ///< printed at its end
  std::string off{};    ///< why it cannot be done now; empty: it can
  std::function<void()> run{};
};

/// Those that a query finds, best match first and what cannot be done last: titles and words that hold every
/// word of the query, and then titles that hold its letters in order. An empty query finds all, as they are.
[[nodiscard]] std::vector<PaletteRow> found_rows(std::vector<PaletteRow> rows, std::string_view query);

/// The frame a query asks for: "417", "frame 417"; nothing where it asks for none.
[[nodiscard]] std::optional<int> frame_asked_for(std::string_view query);

}  // namespace stillpoint
