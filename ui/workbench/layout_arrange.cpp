// Where the tiles of a layout lie: shares of an area, and tabs where there is no room for all.
#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "ui/workbench/layout.hpp"

namespace stillpoint {
namespace {

using Path = std::vector<std::size_t>;

/// A tile, or a division of one, as it is laid out: tiles without room beside each other share a place.
struct Cell {
  bool columns = false;
  std::vector<Cell> children{};
  std::vector<std::string> tabs{};  // of a tile
  std::string front{};              // … the one seen
  double weight = 0.0;              // … its share of the whole
  double share = 1.0;               // of the parent's extent
  std::size_t first = 0, last = 0;  // children of the parent in the tree that it is made of
  std::vector<double> parts{};      // … and their shares
  std::optional<Path> path{};       // in the tree; nothing where it is made of several

  [[nodiscard]] bool is_tile() const { return children.empty(); }
};

Cell cell_of(const LayoutNode& node, double weight, const Path& path) {
  Cell cell;
  cell.share = node.share;
  cell.parts = {node.share};
  cell.path = path;
  if (node.is_panel()) {
    cell.tabs = {node.panel};
    cell.front = node.panel;
    cell.weight = weight;
    return cell;
  }
  cell.columns = node.division == LayoutNode::Division::kColumns;
  for (std::size_t i = 0; i < node.children.size(); ++i) {
    Path to = path;
    to.push_back(i);
    cell.children.push_back(cell_of(node.children[i], weight * node.children[i].share, to));
    cell.children.back().first = cell.children.back().last = i;
  }
  return cell;
}

/// What a cell takes along one axis: all of it beside each other, and in one tile at the least.
struct Needs {
  float apart = 0.0F, folded = 0.0F;
};

Needs needs_of(const Cell& cell, bool along_x, float gap, const LeastOf& least) {
  Needs needs;
  for (const std::string& panel : cell.tabs) {
    const TileSize size = least ? least(panel) : TileSize{};
    needs.apart = std::max(needs.apart, std::ceil(along_x ? size.width : size.height));
  }
  if (cell.is_tile()) return {needs.apart, needs.apart};
  for (const Cell& child : cell.children) {
    const Needs one = needs_of(child, along_x, gap, least);
    needs.apart = cell.columns == along_x ? needs.apart + one.apart : std::max(needs.apart, one.apart);
    needs.folded = std::max(needs.folded, one.folded);
  }
  if (cell.columns == along_x) needs.apart += gap * static_cast<float>(cell.children.size() - 1);
  return needs;
}

std::size_t tiles_in(const Cell& cell) {
  if (cell.is_tile()) return cell.tabs.size();
  return std::accumulate(cell.children.begin(), cell.children.end(), std::size_t{0},
                         [](std::size_t sum, const Cell& child) { return sum + tiles_in(child); });
}

/// Two neighbours in one place: tiles become tabs, and divisions of one kind pair their parts.
Cell merged(Cell a, Cell b) {
  const std::size_t first = a.first, last = b.last;
  const double share = a.share + b.share;
  std::vector<double> parts = a.parts;
  parts.insert(parts.end(), b.parts.begin(), b.parts.end());
  const auto finish = [&](Cell cell) {
    cell.share = share, cell.first = first, cell.last = last;
    cell.parts = std::move(parts);
    cell.path.reset();
    return cell;
  };
  if (a.is_tile() && b.is_tile()) {
    if (b.weight > a.weight) a.front = b.front, a.weight = b.weight;
    a.tabs.insert(a.tabs.end(), b.tabs.begin(), b.tabs.end());
    return finish(std::move(a));
  }
  if (a.is_tile() || b.is_tile()) {
    // The tile goes to the largest of the other's parts.
    const bool a_is_tile = a.is_tile();
    Cell host = a_is_tile ? std::move(b) : std::move(a);
    Cell guest = a_is_tile ? std::move(a) : std::move(b);
    const auto largest =
        std::max_element(host.children.begin(), host.children.end(),
                         [](const Cell& one, const Cell& other) { return one.share < other.share; });
    const double kept = largest->share;
    *largest = a_is_tile ? merged(std::move(guest), std::move(*largest))
                         : merged(std::move(*largest), std::move(guest));
    largest->share = kept;
    return finish(std::move(host));
  }
  Cell& more = a.children.size() >= b.children.size() ? a : b;
  Cell& fewer = &more == &a ? b : a;
  for (std::size_t i = 0; i < fewer.children.size(); ++i) {
    const double kept = more.children[i].share;
    more.children[i] = &more == &a ? merged(std::move(more.children[i]), std::move(fewer.children[i]))
                                   : merged(std::move(fewer.children[i]), std::move(more.children[i]));
    more.children[i].share = kept;
  }
  return finish(std::move(more));
}

/// Siblings' shares with none below what it needs; the rest is shared as they have it.
std::vector<double> settled_shares(const std::vector<Cell>& cells, const std::vector<float>& floors,
                                   float extent) {
  std::vector<double> shares;
  for (const Cell& cell : cells) shares.push_back(cell.share);
  if (extent <= 0.0F) return shares;
  std::vector<bool> fixed(cells.size(), false);
  for (bool again = true; again;) {
    again = false;
    double left = 1.0, free = 0.0;
    for (std::size_t i = 0; i < cells.size(); ++i)
      fixed[i] ? left -= static_cast<double>(floors[i] / extent) : free += cells[i].share;
    for (std::size_t i = 0; i < cells.size(); ++i) {
      if (fixed[i]) {
        shares[i] = static_cast<double>(floors[i] / extent);
        continue;
      }
      // Unless something was fixed, shares stay as they are to the last bit.
      shares[i] = left == 1.0 ? cells[i].share : cells[i].share / free * std::max(left, 0.0);
      if (shares[i] * static_cast<double>(extent) < static_cast<double>(floors[i])) fixed[i] = again = true;
    }
    if (std::all_of(fixed.begin(), fixed.end(), [](bool is) { return is; })) again = false;
  }
  return shares;
}

class Arranger {
 public:
  Arranger(float gap, const LeastOf& least) : gap_(gap), least_(least) {}

  PlacedLayout take() { return std::move(placed_); }

  void place(Cell cell, const LayoutRect& area) {
    if (cell.is_tile()) {
      const bool alone = cell.tabs.size() == 1;
      placed_.panels.push_back({cell.front, area, alone ? std::vector<std::string>() : std::move(cell.tabs)});
      return;
    }
    const float whole = cell.columns ? area.width : area.height;
    const std::vector<float> floors = fold(cell, whole);
    const float extent = std::max(0.0F, whole - gap_ * static_cast<float>(cell.children.size() - 1));
    const std::vector<double> shares = settled_shares(cell.children, floors, extent);
    const std::size_t splitters = placed_.splitters.size();
    double before = 0.0;
    for (std::size_t i = 0; i < cell.children.size(); ++i) {
      const double after = i + 1 == cell.children.size() ? 1.0 : before + shares[i];
      // Edges are rounded, not sizes: so errors do not add up.
      const float low = std::round(static_cast<float>(before) * extent) + gap_ * static_cast<float>(i);
      const float high = std::round(static_cast<float>(after) * extent) + gap_ * static_cast<float>(i);
      place(cell.children[i], cell.columns ? LayoutRect{area.x + low, area.y, high - low, area.height}
                                           : LayoutRect{area.x, area.y + low, area.width, high - low});
      if (i + 1 < cell.children.size() && cell.path)
        split(cell, i, floors,
              cell.columns ? LayoutRect{area.x + high, area.y, gap_, area.height}
                           : LayoutRect{area.x, area.y + high, area.width, gap_},
              extent);
      before = after;
    }
    tell_shares(cell, shares, splitters);
  }

 private:
  /// Has children share places until all have room. @returns px that each needs
  std::vector<float> fold(Cell& cell, float whole) const {
    std::vector<Needs> needs;
    const auto measure = [&] {
      needs.clear();
      for (const Cell& child : cell.children) needs.push_back(needs_of(child, cell.columns, gap_, least_));
    };
    const auto spare = [&] {
      float left = whole - gap_ * static_cast<float>(needs.size() - 1);
      for (const Needs& one : needs) left -= one.folded;
      return left;
    };
    measure();
    while (cell.children.size() > 1 && spare() < 0.0F) {
      merge_one(cell);
      measure();
    }
    std::vector<float> floors;
    for (const Needs& one : needs) floors.push_back(one.folded);
    // What is left goes to those that would else be tabs, the least wish first.
    float left = spare();
    std::vector<std::size_t> order(needs.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      return needs[a].apart - needs[a].folded < needs[b].apart - needs[b].folded;
    });
    for (const std::size_t i : order) {
      const float more = needs[i].apart - needs[i].folded;
      if (more > left) break;
      floors[i] += more;
      left -= more;
    }
    return floors;
  }

  /// The two neighbours that hold the fewest tiles share a place from now on; of several, the last.
  static void merge_one(Cell& cell) {
    std::size_t at = 0, fewest = 0;
    for (std::size_t i = 0; i + 1 < cell.children.size(); ++i) {
      const std::size_t tiles = tiles_in(cell.children[i]) + tiles_in(cell.children[i + 1]);
      if (i == 0 || tiles <= fewest) at = i, fewest = tiles;
    }
    const auto place = cell.children.begin() + static_cast<std::ptrdiff_t>(at);
    *place = merged(std::move(*place), std::move(*(place + 1)));
    cell.children.erase(place + 1);
  }

  void split(const Cell& cell, std::size_t i, const std::vector<float>& floors, const LayoutRect& rect,
             float extent) {
    const Cell &one = cell.children[i], &next = cell.children[i + 1];
    placed_.splitters.push_back({.path = *cell.path,
                                 .before = one.last,
                                 .upright = cell.columns,
                                 .rect = rect,
                                 .extent = extent,
                                 .first = one.first,
                                 .last = next.last,
                                 .least_before = floors[i],
                                 .least_after = floors[i + 1]});
  }

  /// Tells a division's splitters the shares that its children in the tree were laid out with.
  void tell_shares(const Cell& cell, const std::vector<double>& shares, std::size_t from) {
    if (!cell.path) return;
    std::vector<double> all;
    for (std::size_t i = 0; i < cell.children.size(); ++i)
      for (const double part : cell.children[i].parts)
        all.push_back(shares[i] * part / cell.children[i].share);
    for (std::size_t i = from; i < placed_.splitters.size(); ++i)
      if (placed_.splitters[i].path == *cell.path) placed_.splitters[i].shares = all;
  }

  float gap_;
  const LeastOf& least_;
  PlacedLayout placed_;
};

}  // namespace

PlacedLayout arrange(const LayoutNode& root, const LayoutRect& area, float gap, const LeastOf& least) {
  Arranger arranger(gap, least);
  arranger.place(cell_of(root, 1.0, {}), area);
  return arranger.take();
}

void drag(LayoutNode& root, const PlacedSplitter& splitter, float delta, float least) {
  LayoutNode* parent = &root;
  for (const std::size_t index : splitter.path) parent = &parent->children.at(index);
  if (splitter.extent <= 0.0F) return;
  std::vector<LayoutNode>& children = parent->children;
  // What lies where it does because another has no room is moved from there, not from where its share says.
  for (std::size_t i = 0; i < std::min(children.size(), splitter.shares.size()); ++i)
    children[i].share = splitter.shares[i];
  const auto sum = [&](std::size_t from, std::size_t to) {
    double all = 0.0;
    for (std::size_t i = from; i <= to; ++i) all += children.at(i).share;
    return all;
  };
  const double before = sum(splitter.first, splitter.before), after = sum(splitter.before + 1, splitter.last);
  const double both = before + after, extent = static_cast<double>(splitter.extent);
  double low = static_cast<double>(std::max(least, splitter.least_before)) / extent,
         high = both - static_cast<double>(std::max(least, splitter.least_after)) / extent;
  if (low > high) low = high = std::clamp(before, std::min(low, high), std::max(low, high));
  const double wanted = std::clamp(before + static_cast<double>(delta) / extent, low, high);
  for (std::size_t i = splitter.first; i <= splitter.before; ++i) children[i].share *= wanted / before;
  for (std::size_t i = splitter.before + 1; i <= splitter.last; ++i)
    children[i].share *= (both - wanted) / after;
}

}  // namespace stillpoint
