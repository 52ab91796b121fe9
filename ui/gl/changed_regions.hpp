#pragma once

#include <imgui.h>

#include <cstdint>
#include <vector>

namespace stillpoint {

/// Pixels x0 to x1, y0 to y1, the last ones not among them; origin top left.
struct PixelRect {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
  [[nodiscard]] bool empty() const { return x0 >= x1 || y0 >= y1; }
  [[nodiscard]] std::int64_t area() const {  ///< px, of one that is not empty
    return static_cast<std::int64_t>(x1 - x0) * (y1 - y0);
  }
  [[nodiscard]] PixelRect cut_to(const PixelRect& other) const;
};

/// How a shape may be drawn at least expense.
enum class Drawing {
  kBlended,  ///< as all can be
  kOpaque,   ///< a picture without alpha, not seen through: nothing below it matters
  kFill,     ///< a rectangle of whole pixels in one opaque colour
};

/// Triangles of one draw command that lie together in its buffers, as ImGui makes a letter or a circle.
struct DrawnShape {
  std::uint32_t first_index = 0, indices = 0;  ///< in the command's list
  PixelRect box;                               ///< where its pixels may lie, cut to the command's clip; just
                                               ///< there, if it is a fill
  Drawing drawing = Drawing::kBlended;
  ImU32 colour = 0;  ///< of a fill
};

/// A draw command and its shapes.
struct DrawnCommand {
  const ImDrawCmd* command = nullptr;
  PixelRect clip;
  std::vector<DrawnShape>::size_type first_shape = 0, shapes = 0;  ///< in ChangedRegions::shapes()
};

/// Where a frame of the interface differs from the one before: all that is drawn is told apart by small cells
/// of the picture, so that only those need be drawn again.
class ChangedRegions {
 public:
  /// @param width, height of the picture, px
  /// @returns rectangles without overlap that hold every changed pixel; the whole the first time, and where
  /// the size is another
  const std::vector<PixelRect>& update(const ImDrawData& data, int width, int height);

  /// The picture is not what was drawn last: all of it has changed.
  void forget() { width_ = height_ = 0; }

  // Of the frame given to update() last.
  /// @param list index into ImDrawData::CmdLists
  [[nodiscard]] const std::vector<DrawnCommand>& commands(int list) const {
    return commands_[static_cast<std::size_t>(list)];
  }
  [[nodiscard]] const std::vector<DrawnShape>& shapes() const { return shapes_; }

 private:
  /// Indices of a command that make a shape, and the vertices they are of.
  struct Run {
    std::uint32_t first = 0, count = 0;     // in the list's indices
    std::uint32_t lowest = 0, highest = 0;  // in the command's vertices
  };
  void add_list(const ImDrawList& list, std::vector<DrawnCommand>& commands);
  void add_shape(const ImDrawList& list, const DrawnCommand& command, const Run& run);
  void collect_changes(const std::vector<std::uint64_t>& before, bool all);

  int width_ = 0, height_ = 0, columns_ = 0;
  ImVec2 origin_, scale_;             // of the picture in ImGui's coordinates
  std::vector<std::uint64_t> cells_;  // what is drawn in each, in its order, as a hash
  std::vector<std::vector<DrawnCommand>> commands_;
  std::vector<DrawnShape> shapes_;
  std::vector<PixelRect> changed_;
};

}  // namespace stillpoint
