#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <utility>
#include <vector>

#include "core/sequence/generated/random.hpp"

namespace stillpoint::generated {

// What pictures are drawn with. Images are CV_8UC3; colours BGR, 0 to 255.

using Colour = cv::Scalar;

[[nodiscard]] cv::Mat canvas(int width, int height, const Colour& colour);
[[nodiscard]] cv::Point random_point(Dice& dice, const cv::Mat& image);
/// A saturated colour of any hue.
[[nodiscard]] Colour vivid(Dice& dice);
/// Adds noise that repeats at the edges: pairs of grain size (px) and strength (grey levels), the grains
/// longer along x by `stretch_x`.
void add_grain(cv::Mat& image, Dice& dice, const std::vector<std::pair<int, double>>& grains,
               double stretch_x = 1);
[[nodiscard]] std::string nonsense(Dice& dice, int letters);
/// Rows of words, as on a printed page.
void write_rows(cv::Mat& image, Dice& dice, const cv::Rect& where, double size, const Colour& ink);
/// Discs, bars, lines and arcs of sizes between two radii (px).
void scatter_shapes(cv::Mat image, Dice& dice, int count, int smallest, int largest);

// Printed things; `style` chooses among layouts.
[[nodiscard]] cv::Mat poster(Dice& dice, int style);
[[nodiscard]] cv::Mat spine(Dice& dice, int style);
[[nodiscard]] cv::Mat keyboard(Dice& dice);
[[nodiscard]] cv::Mat screen(Dice& dice);
[[nodiscard]] cv::Mat whiteboard(Dice& dice);
[[nodiscard]] cv::Mat cardboard(Dice& dice);
[[nodiscard]] cv::Mat cover(Dice& dice);
[[nodiscard]] cv::Mat page(Dice& dice);
[[nodiscard]] cv::Mat mug(Dice& dice);

}  // namespace stillpoint::generated
