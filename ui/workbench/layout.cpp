#include "ui/workbench/layout.hpp"

#include <algorithm>
#include <numeric>

namespace stillpoint {
namespace {

using Division = LayoutNode::Division;

LayoutNode* find(LayoutNode& node, std::string_view panel) {
  if (node.is_panel()) return node.panel == panel ? &node : nullptr;
  for (LayoutNode& child : node.children)
    if (LayoutNode* found = find(child, panel)) return found;
  return nullptr;
}

/// A division of one child is that child; one that divides as its parent does belongs into it.
void simplify(LayoutNode& node) {
  for (LayoutNode& child : node.children) simplify(child);
  if (node.children.size() == 1) {
    const double share = node.share;
    LayoutNode only = std::move(node.children.front());
    node = std::move(only);
    node.share = share;
  }
}

bool erase(LayoutNode& node, std::string_view panel) {
  for (auto child = node.children.begin(); child != node.children.end(); ++child) {
    if (!child->is_panel()) {
      if (erase(*child, panel)) return true;
      continue;
    }
    if (child->panel != panel) continue;
    node.children.erase(child);
    const double left = std::accumulate(node.children.begin(), node.children.end(), 0.0,
                                        [](double sum, const LayoutNode& n) { return sum + n.share; });
    for (LayoutNode& other : node.children) other.share /= left;
    return true;
  }
  return false;
}

LayoutNode tile(double share, std::string panel) {
  LayoutNode node;
  node.share = share;
  node.panel = std::move(panel);
  return node;
}

LayoutNode divide(double share, Division division, std::vector<LayoutNode> children) {
  LayoutNode node;
  node.share = share;
  node.division = division;
  node.children = std::move(children);
  return node;
}

}  // namespace

std::vector<std::string> panels_of(const LayoutNode& root) {
  if (root.is_panel()) return {root.panel};
  std::vector<std::string> panels;
  for (const LayoutNode& child : root.children)
    for (std::string& panel : panels_of(child)) panels.push_back(std::move(panel));
  return panels;
}

bool contains(const LayoutNode& root, std::string_view panel) {
  if (root.is_panel()) return root.panel == panel;
  return std::any_of(root.children.begin(), root.children.end(),
                     [&](const LayoutNode& child) { return contains(child, panel); });
}

void remove_panel(LayoutNode& root, std::string_view panel) {
  if (root.is_panel()) return;
  erase(root, panel);
  simplify(root);
}

void replace_panel(LayoutNode& root, std::string_view panel, const std::string& wanted) {
  LayoutNode* place = find(root, panel);
  if (place == nullptr || place->panel == wanted) return;
  if (LayoutNode* other = find(root, wanted)) other->panel = place->panel;
  place->panel = wanted;
}

void add_panel(LayoutNode& root, const std::string& panel, const LayoutRect& area) {
  if (contains(root, panel)) return;
  const PlacedLayout placed = arrange(root, area, 0.0F);
  const auto largest = std::max_element(placed.panels.begin(), placed.panels.end(),
                                        [](const PlacedPanel& a, const PlacedPanel& b) {
                                          return a.rect.width * a.rect.height < b.rect.width * b.rect.height;
                                        });
  LayoutNode& place = *find(root, largest->panel);
  const Division division =
      largest->rect.width >= largest->rect.height ? Division::kColumns : Division::kRows;
  place = divide(place.share, division, {tile(0.5, place.panel), tile(0.5, panel)});
}

/// Panels that show a method's stages, as the method names them.
std::vector<std::string> stage_panels(std::string_view method) {
  for (const MethodInfo& info : methods())
    if (info.name == method && !info.panels.empty()) return info.panels;
  return {"motion"};
}

LayoutNode default_layout(std::string_view method, bool stereo) {
  using enum Division;
  // Above, what is classified as dynamic and which features that takes, by what the method itself goes by; in
  // the middle what comes of it; below, the whole run to go about in.
  const std::vector<std::string> stages = stage_panels(method);
  std::vector<LayoutNode> tiles{tile(stages.size() > 1 ? 0.25 : 0.29, "features_before")};
  for (std::size_t i = 0; i < std::min<std::size_t>(3, stages.size()); ++i)
    tiles.push_back(tile(stages.size() > 1 ? 0.25 : 0.42, stages[i]));
  if (stages.size() == 1) tiles.push_back(tile(0.29, "features_after"));
  if (stereo) {
    constexpr double kDisparity = 0.22;  // share of the column that a pair's disparity takes
    for (LayoutNode& other : tiles) other.share *= 1.0 - kDisparity;
    tiles.push_back(tile(kDisparity, "disparity"));
  }
  const LayoutNode found = divide(0.42, kColumns, tiles);
  return divide(
      1.0, kRows,
      {found,
       divide(0.34, kColumns, {tile(0.38, "trajectory"), tile(0.38, "errors"), tile(0.24, "inspector")}),
       tile(0.24, "timeline")});
}

namespace {

using enum Division;

/// The method's way: its own panels in rows of three, or its stages at a glance beside the mask.
LayoutNode motion_layout(std::string_view method) {
  const std::vector<std::string> stages = stage_panels(method);
  std::vector<LayoutNode> rows;
  for (std::size_t i = 0; i + 2 < stages.size(); i += 3)
    rows.insert(
        rows.begin(),
        divide(0.5, kColumns, {tile(0.33, stages[i]), tile(0.33, stages[i + 1]), tile(0.34, stages[i + 2])}));
  if (rows.empty()) {
    LayoutNode mask_and_stages = divide(0.42, kColumns, {tile(0.4, "mask"), tile(0.6, "stages")});
    rows = stages.front() == "mask"
               ? std::vector<LayoutNode>{std::move(mask_and_stages)}
               : std::vector<LayoutNode>{tile(0.58, stages.front()), std::move(mask_and_stages)};
  }
  return divide(1.0, kRows,
                {divide(0.78, kColumns, {divide(0.74, kRows, rows), tile(0.26, "parameters")}),
                 tile(0.22, "timeline")});
}

/// Runs beside each other: where they went, how far off, what each took out.
LayoutNode compare_layout(std::string_view) {
  return divide(1.0, kColumns,
                {divide(0.26, kRows, {tile(0.62, "parameters"), tile(0.38, "removal")}),
                 divide(0.4, kRows, {tile(0.62, "compare"), tile(0.38, "timeline")}),
                 divide(0.34, kRows, {tile(0.55, "trajectory"), tile(0.45, "errors")})});
}

/// From the whole run to its worst frames and why they are bad.
LayoutNode failures_layout(std::string_view) {
  return divide(
      1.0, kRows,
      {divide(0.55, kColumns,
              {tile(0.3, "features_after"), tile(0.3, "mask"),
               divide(0.4, kColumns, {tile(0.55, "breakpoints"), tile(0.45, "bookmarks")})}),
       divide(0.45, kColumns,
              {tile(0.5, "timeline"), divide(0.3, kRows, {tile(0.5, "errors"), tile(0.5, "removal")}),
               tile(0.2, "inspector")})});
}

/// One frame from within: its stages, and what pixels and features there say.
LayoutNode stages_layout(std::string_view) {
  return divide(1.0, kRows,
                {divide(0.78, kColumns,
                        {tile(0.48, "stages"),
                         divide(0.28, kRows, {tile(0.46, "features_before"), tile(0.54, "feature")}),
                         tile(0.24, "inspector")}),
                 tile(0.22, "timeline")});
}

/// What a stereo pair's depth is made of, and what becomes of it.
LayoutNode stereo_layout(std::string_view) {
  return divide(1.0, kRows,
                {divide(0.48, kColumns, {tile(0.5, "disparity"), tile(0.5, "stereo_holes")}),
                 divide(0.34, kColumns,
                        {tile(0.3, "input"), tile(0.3, "features_after"), tile(0.25, "trajectory"),
                         tile(0.15, "inspector")}),
                 tile(0.18, "timeline")});
}

}  // namespace

std::vector<NamedLayout> named_layouts() {
  return {{"inspect", "Inspect", [](std::string_view method) { return default_layout(method); }},
          {"motion", "Motion", motion_layout},
          {"compare", "Compare", compare_layout},
          {"failures", "Failures", failures_layout},
          {"stages", "Stages", stages_layout},
          {"stereo", "Stereo", stereo_layout}};
}

LayoutNode fitted(const LayoutNode& layout, std::string_view method, bool stereo) {
  const std::vector<std::string> panels = panels_of(layout);
  const auto remade = [&](const LayoutNode& wanted) { return panels_of(wanted) == panels ? layout : wanted; };
  for (const MethodInfo& other : methods()) {
    for (const bool pairs : {false, true})
      if (panels == panels_of(default_layout(other.name, pairs)))
        return remade(default_layout(method, stereo));
    for (const NamedLayout& named : named_layouts())
      if (panels == panels_of(named.make(other.name))) return remade(named.make(method));
  }
  return layout;
}

}  // namespace stillpoint
