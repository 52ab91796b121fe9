#include "ui/gl/changed_regions.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <utility>

#include "ui/gl/texture.hpp"

namespace stillpoint {
namespace {

constexpr int kCell = 32;                    // px
constexpr std::uint32_t kShapeIndices = 96;  // at most: long curves are told apart piece by piece
constexpr float kFarthest = 1e6F;  // px; beyond it, and where it is no number, whole pixels cannot say it
constexpr std::size_t kMostRegions = 12;  // more are drawn as one: each costs a pass over the shapes

std::uint64_t mixed(std::uint64_t hash, std::uint64_t value) {
  hash = (hash ^ value) * 0x9E3779B97F4A7C15U;
  return hash ^ (hash >> 29U);
}

/// @param less taken from each whole word of the data
std::uint64_t hashed(std::uint64_t hash, const void* data, std::size_t bytes, std::uint64_t less = 0) {
  const auto* at = static_cast<const unsigned char*>(data);
  std::uint64_t word = 0;
  // A word waits for the one before it only in a lane of its own.
  std::array<std::uint64_t, 4> lanes{hash, hash + 1, hash + 2, hash + 3};
  std::array<std::uint64_t, 4> words{};
  for (; bytes >= sizeof(words); bytes -= sizeof(words), at += sizeof(words)) {
    std::memcpy(words.data(), at, sizeof(words));
    for (std::size_t i = 0; i < lanes.size(); ++i) lanes[i] = mixed(lanes[i], words[i] - less);
  }
  for (const std::uint64_t lane : lanes) hash = mixed(hash, lane);
  for (; bytes >= sizeof(word); bytes -= sizeof(word), at += sizeof(word)) {
    std::memcpy(&word, at, sizeof(word));
    hash = mixed(hash, word - less);
  }
  word = 0;
  std::memcpy(&word, at, bytes);
  return mixed(hash, word);
}

/// Of indices, as counted from the lowest of them: where a shape lies in its buffers does not matter.
std::uint64_t hashed_indices(std::uint64_t hash, const ImDrawIdx* indices, std::size_t count,
                             std::uint32_t lowest) {
  constexpr std::size_t kInWord = sizeof(std::uint64_t) / sizeof(ImDrawIdx);
  // None is lower, so that taking it from all of a word at once borrows nothing.
  std::uint64_t less = 0;
  for (std::size_t i = 0; i < kInWord; ++i) less |= std::uint64_t{lowest} << (8 * sizeof(ImDrawIdx) * i);
  const std::size_t whole = count - count % kInWord;
  hash = hashed(hash, indices, whole * sizeof(ImDrawIdx), less);
  for (std::size_t i = whole; i < count; ++i) hash = mixed(hash, indices[i] - lowest);
  return hash;
}

/// Whether four corners have one colour and one place in the texture, as ImGui's plain rectangles have.
bool is_plain(const ImDrawVert* corner) {
  return std::all_of(corner, corner + 4, [&](const ImDrawVert& other) {
    return other.col == corner->col && other.uv.x == corner->uv.x && other.uv.y == corner->uv.y;
  });
}

/// How a rectangle of four corners may be drawn.
/// @param least, most its corners in the picture, px
Drawing drawing_of(const ImDrawVert* corner, ImVec2 least, ImVec2 most, ImTextureID texture) {
  constexpr float kFromMiddle = 0.01F;  // px: nearer to a pixel's middle, rounding says whether it is filled
  const ImVec2 low = corner[0].pos, high = corner[2].pos;
  const bool upright = corner[1].pos.x == high.x && corner[1].pos.y == low.y && corner[3].pos.x == low.x &&
                       corner[3].pos.y == high.y;
  const bool opaque = std::all_of(corner, corner + 4, [](const ImDrawVert& vertex) {
    return (vertex.col & IM_COL32_A_MASK) == IM_COL32_A_MASK;
  });
  if (!upright || !opaque) return Drawing::kBlended;
  if (is_opaque(texture)) return Drawing::kOpaque;
  const auto decided = [&](float edge) { return std::abs(edge - std::floor(edge) - 0.5F) > kFromMiddle; };
  const bool whole = decided(least.x) && decided(least.y) && decided(most.x) && decided(most.y);
  return is_plain(corner) && whole ? Drawing::kFill : Drawing::kBlended;
}

PixelRect around(const PixelRect& a, const PixelRect& b) {
  return {std::min(a.x0, b.x0), std::min(a.y0, b.y0), std::max(a.x1, b.x1), std::max(a.y1, b.y1)};
}

}  // namespace

PixelRect PixelRect::cut_to(const PixelRect& other) const {
  return {std::max(x0, other.x0), std::max(y0, other.y0), std::min(x1, other.x1), std::min(y1, other.y1)};
}

void ChangedRegions::add_shape(const ImDrawList& list, const DrawnCommand& command, const Run& run) {
  const ImDrawIdx* indices = list.IdxBuffer.Data + run.first;
  const ImDrawVert* vertices = list.VtxBuffer.Data + command.command->VtxOffset;
  ImVec2 least = vertices[run.lowest].pos, most = least;
  for (std::size_t i = run.lowest; i <= run.highest; ++i) {
    least = {std::min(least.x, vertices[i].pos.x), std::min(least.y, vertices[i].pos.y)};
    most = {std::max(most.x, vertices[i].pos.x), std::max(most.y, vertices[i].pos.y)};
  }
  least = {(least.x - origin_.x) * scale_.x, (least.y - origin_.y) * scale_.y};
  most = {(most.x - origin_.x) * scale_.x, (most.y - origin_.y) * scale_.y};
  const auto pixel = [](float value) {
    return value > -kFarthest ? static_cast<int>(std::floor(std::min(value, kFarthest)))
                              : -static_cast<int>(kFarthest);
  };
  DrawnShape shape;
  shape.first_index = run.first;
  shape.indices = run.count;
  shape.box = {pixel(least.x), pixel(least.y), pixel(most.x) + 1, pixel(most.y) + 1};
  if (run.count == 6 && run.highest - run.lowest == 3)
    shape.drawing = drawing_of(vertices + run.lowest, least, most, command.command->GetTexID());
  if (shape.drawing == Drawing::kFill) {
    shape.colour = vertices[run.lowest].col;
    // Pixels whose middles it covers.
    shape.box = {pixel(least.x + 0.5F), pixel(least.y + 0.5F), pixel(most.x + 0.5F), pixel(most.y + 0.5F)};
  }
  shape.box = shape.box.cut_to(command.clip);
  const PixelRect& box = shape.box;
  if (box.empty()) return;
  shapes_.push_back(shape);
  std::uint64_t hash =
      hashed(0, vertices + run.lowest, (run.highest - run.lowest + std::size_t{1}) * sizeof(ImDrawVert));
  hash = hashed_indices(hash, indices, run.count, run.lowest);
  const ImTextureID texture = command.command->GetTexID();
  hash = hashed(hash, &texture, sizeof(texture));
  hash = hashed(hash, &command.clip, sizeof(command.clip));
  for (int y = box.y0 / kCell; y <= (box.y1 - 1) / kCell; ++y)
    for (int x = box.x0 / kCell; x <= (box.x1 - 1) / kCell; ++x) {
      std::uint64_t& cell = cells_[static_cast<std::size_t>(y * columns_ + x)];
      cell = mixed(cell, hash);
    }
}

void ChangedRegions::add_list(const ImDrawList& list, std::vector<DrawnCommand>& commands) {
  for (const ImDrawCmd& command : list.CmdBuffer) {
    if (command.UserCallback != nullptr || command.ElemCount == 0) continue;
    const ImVec2 low{std::max((command.ClipRect.x - origin_.x) * scale_.x, 0.0F),
                     std::max((command.ClipRect.y - origin_.y) * scale_.y, 0.0F)};
    const ImVec2 high{(command.ClipRect.z - origin_.x) * scale_.x,
                      (command.ClipRect.w - origin_.y) * scale_.y};
    if (high.x <= low.x || high.y <= low.y) continue;
    // Counted from below, as OpenGL does: that decides which way half pixels go.
    const int left = static_cast<int>(low.x);
    const int bottom = height_ - static_cast<int>(static_cast<float>(height_) - high.y);
    const PixelRect clip = PixelRect{left, bottom - static_cast<int>(high.y - low.y),
                                     left + static_cast<int>(high.x - low.x), bottom}
                               .cut_to({0, 0, width_, height_});
    if (clip.empty()) continue;
    DrawnCommand drawn{.command = &command, .clip = clip, .first_shape = shapes_.size()};
    // A triangle whose corners all come after those of the triangles before it begins another shape.
    const ImDrawIdx* indices = list.IdxBuffer.Data;
    Run run{.first = command.IdxOffset};
    const std::uint32_t end = command.IdxOffset + command.ElemCount;
    for (std::uint32_t at = run.first; at < end; at += 3) {
      const auto [lowest, highest] =
          std::minmax<std::uint32_t>({indices[at], indices[at + 1], indices[at + 2]});
      if (run.count > 0 && (lowest > run.highest || run.count >= kShapeIndices)) {
        add_shape(list, drawn, run);
        run = {.first = at};
      }
      run.lowest = run.count == 0 ? lowest : std::min(run.lowest, lowest);
      run.highest = std::max(run.highest, highest);
      run.count += 3;
    }
    add_shape(list, drawn, run);
    drawn.shapes = shapes_.size() - drawn.first_shape;
    commands.push_back(drawn);
  }
}

void ChangedRegions::collect_changes(const std::vector<std::uint64_t>& before, bool all) {
  changed_.clear();
  const PixelRect whole{0, 0, width_, height_};
  if (all) {
    changed_.push_back(whole);
    return;
  }
  const int rows = static_cast<int>(cells_.size()) / std::max(columns_, 1);
  for (int y = 0; y < rows; ++y)
    for (int x = 0; x < columns_;) {
      const auto differs = [&](int column) {
        const auto at = static_cast<std::size_t>(y * columns_ + column);
        return cells_[at] != before[at];
      };
      const int from = x++;
      if (!differs(from)) continue;
      while (x < columns_ && differs(x)) ++x;
      const PixelRect run{from * kCell, y * kCell, x * kCell, (y + 1) * kCell};
      const auto above = std::find_if(changed_.begin(), changed_.end(), [&](const PixelRect& other) {
        return other.y1 == run.y0 && other.x0 == run.x0 && other.x1 == run.x1;
      });
      if (above != changed_.end())
        above->y1 = run.y1;
      else
        changed_.push_back(run);
    }
  // Where there are many, those are joined whose common rectangle adds least.
  while (changed_.size() > kMostRegions) {
    std::pair<std::size_t, std::size_t> best{0, 1};
    std::int64_t least = -1;
    for (std::size_t i = 0; i < changed_.size(); ++i)
      for (std::size_t j = i + 1; j < changed_.size(); ++j) {
        const std::int64_t added =
            around(changed_[i], changed_[j]).area() - changed_[i].area() - changed_[j].area();
        if (least >= 0 && added >= least) continue;
        least = std::max<std::int64_t>(added, 0);
        best = {i, j};
      }
    PixelRect joined = around(changed_[best.first], changed_[best.second]);
    changed_.erase(changed_.begin() + static_cast<std::ptrdiff_t>(best.second));
    changed_.erase(changed_.begin() + static_cast<std::ptrdiff_t>(best.first));
    // Nothing may be drawn twice: what the common rectangle reaches into joins as well.
    for (std::size_t i = 0; i < changed_.size();) {
      if (changed_[i].cut_to(joined).empty()) {
        ++i;
        continue;
      }
      joined = around(joined, changed_[i]);
      changed_.erase(changed_.begin() + static_cast<std::ptrdiff_t>(i));
      i = 0;
    }
    changed_.push_back(joined);
  }
  for (PixelRect& region : changed_) region = region.cut_to(whole);
}

const std::vector<PixelRect>& ChangedRegions::update(const ImDrawData& data, int width, int height) {
  origin_ = data.DisplayPos;
  scale_ = data.FramebufferScale;
  const bool all = width != width_ || height != height_;
  width_ = width;
  height_ = height;
  columns_ = (width + kCell - 1) / kCell;
  const auto count =
      static_cast<std::size_t>(columns_) * static_cast<std::size_t>((height + kCell - 1) / kCell);
  const std::vector<std::uint64_t> before = std::exchange(cells_, std::vector<std::uint64_t>(count));
  shapes_.clear();
  commands_.resize(static_cast<std::size_t>(data.CmdListsCount));
  for (int n = 0; n < data.CmdListsCount; ++n) {
    std::vector<DrawnCommand>& commands = commands_[static_cast<std::size_t>(n)];
    commands.clear();
    add_list(*data.CmdLists[n], commands);
  }
  collect_changes(before, all);
  return changed_;
}

}  // namespace stillpoint
