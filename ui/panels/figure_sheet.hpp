#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "ui/gl/texture.hpp"

namespace stillpoint {

struct SessionView;
struct UiFrame;

/// A picture of a figure, and what stands below it.
struct FigureCell {
  std::string letter;   ///< "a"
  std::string caption;  ///< what it shows, and its figures
  cv::Mat picture;      ///< CV_8UC1 or CV_8UC3
};

/// The paper's figure 1 of the frame shown: frame t-1, frame t, t-1 compensated, forward mask, backward mask
/// (as the union takes it, carried into frame t's camera), union.
/// @returns nothing where the frame has none of these, because it has no reference or cannot be read
[[nodiscard]] std::vector<FigureCell> figure_1_cells(const SessionView& session);

/// Pictures in rows and columns, each with its letter and caption, under a heading, for print.
class FigureSheet {
 public:
  FigureSheet(std::string heading, std::vector<FigureCell> cells, int columns);

  /// Its size, px, when pictures are shown at `picture_scale` times theirs, and text at its design size.
  [[nodiscard]] std::pair<int, int> size(double picture_scale = 1.0) const;

  /// Draws it over the whole frame.
  void draw(UiFrame& frame);

 private:
  std::string heading_;
  std::vector<FigureCell> cells_;
  int columns_;
  std::vector<Texture> textures_;
};

}  // namespace stillpoint
