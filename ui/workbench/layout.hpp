#pragma once

#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "core/motion/methods.hpp"

namespace stillpoint {

// The tiling of the workbench: plain data and arithmetic, without GL or ImGui.

/// A tile: a panel, or a division of its area among children side by side (columns) or one below the other
/// (rows). A node with children holds no panel.
struct LayoutNode {
  enum class Division { kColumns, kRows };
  std::string panel;  ///< name of the panel; empty with children
  Division division = Division::kColumns;
  std::vector<LayoutNode> children{};
  std::map<std::string, std::string> choices{};  ///< of the panel's controls, as PanelChoices has them
  bool front = false;  ///< of panels that share a place for want of room, this is the one seen
  double share = 1.0;  ///< of the parent's extent; siblings' shares add up to 1

  [[nodiscard]] bool is_panel() const { return children.empty(); }
  bool operator==(const LayoutNode&) const = default;
};

/// An area in px, origin top left.
struct LayoutRect {
  float x = 0.0F, y = 0.0F, width = 0.0F, height = 0.0F;
  bool operator==(const LayoutRect&) const = default;
};

/// px.
struct TileSize {
  float width = 0.0F, height = 0.0F;
};

/// The least tile in which a panel can be read.
using LeastOf = std::function<TileSize(const std::string& panel)>;

/// Where a panel lies.
struct PlacedPanel {
  std::string panel;  ///< what is seen there: of several, the one with the largest share
  LayoutRect rect;
  std::vector<std::string> tabs{};  ///< all that share the place, in reading order; one alone has none
};

/// The gap between two siblings, by which their shares are changed.
struct PlacedSplitter {
  std::vector<std::size_t> path;  ///< to the parent: indices of children, from the root
  std::size_t before = 0;         ///< index of the child before the gap
  bool upright = false;           ///< between columns: dragged sideways
  LayoutRect rect;                ///< px, the gap itself
  float extent = 0.0F;            ///< px that the parent's children share
  std::size_t first = 0,
              last = 0;  ///< children that share a place: first … before lie before the gap, up to last after
  std::vector<double> shares{};                   ///< of all the parent's children, as they were laid out
  float least_before = 0.0F, least_after = 0.0F;  ///< px that either side needs
};

struct PlacedLayout {
  std::vector<PlacedPanel> panels;
  std::vector<PlacedSplitter> splitters;
};

/// Lays a tree out in an area, `gap` px between tiles. Positions are whole pixels and leave no px unused.
///
/// A tile whose share is less than its panel needs takes from its siblings. Where all of them have no room
/// beside one another, neighbours become tabs of one tile, until what is left fits: no tile is smaller than
/// `least` says, unless the whole area is. What becomes a tab depends on the area alone, not on shares, so
/// that nothing changes places while a splitter is dragged.
/// @param least empty: nothing needs any room
[[nodiscard]] PlacedLayout arrange(const LayoutNode& root, const LayoutRect& area, float gap,
                                   const LeastOf& least = {});

/// Moves a splitter by `delta` px; no tile gets smaller than `least` px, or than it can be read in, unless
/// there is no room anyway.
void drag(LayoutNode& root, const PlacedSplitter& splitter, float delta, float least);

/// Whether a panel is shown, and the panels shown in reading order.
[[nodiscard]] bool contains(const LayoutNode& root, std::string_view panel);
[[nodiscard]] std::vector<std::string> panels_of(const LayoutNode& root);

/// Takes a panel out; its neighbours take its place. The last one stays.
void remove_panel(LayoutNode& root, std::string_view panel);

/// Puts `wanted` where `panel` is; where both are shown they change places.
void replace_panel(LayoutNode& root, std::string_view panel, const std::string& wanted);

/// Adds a panel that is not there yet: in one half of the largest tile, divided across its longer side.
void add_panel(LayoutNode& root, const std::string& panel, const LayoutRect& area);

/// What a newcomer sees of a run by this method.
/// @param stereo of a sequence of stereo pairs: disparity has a tile, too
[[nodiscard]] LayoutNode default_layout(std::string_view method = kDefaultMethod, bool stereo = false);

/// A layout as it is for another method, or for stereo pairs: one of the program's own, whose tiles go by
/// these, is made anew; one whose panels somebody chose stays.
[[nodiscard]] LayoutNode fitted(const LayoutNode& layout, std::string_view method, bool stereo);

/// A layout for one kind of work.
struct NamedLayout {
  std::string_view name, title;  ///< "failures", "Failures"
  LayoutNode (*make)(std::string_view method);
};

/// Inspect (the default layout), Motion, Compare, Failures, Stages.
[[nodiscard]] std::vector<NamedLayout> named_layouts();

/// The tree as JSON: {"columns": [{"share": 0.4, "panel": "input", "choices": {"Map points": "off"}},
/// {"share": 0.6, "rows": […]}]}.
[[nodiscard]] std::string to_json(const LayoutNode& root);

/// Reads to_json()'s text. Shares that do not add up to 1 are scaled; left out, they are equal.
/// @param name of the file, for messages
/// @param known names of the panels there are
/// @throws InputError for what is no such JSON, an unknown panel or one named twice
[[nodiscard]] LayoutNode parse_layout(const std::string& text, const std::string& name,
                                      const std::vector<std::string>& known);

}  // namespace stillpoint
