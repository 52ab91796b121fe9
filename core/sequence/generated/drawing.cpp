#include "core/sequence/generated/drawing.hpp"

#include <algorithm>
#include <opencv2/imgproc.hpp>

namespace stillpoint::generated {

cv::Mat canvas(int width, int height, const Colour& colour) { return {height, width, CV_8UC3, colour}; }

cv::Point random_point(Dice& dice, const cv::Mat& image) {
  return {dice.below(image.cols), dice.below(image.rows)};
}

Colour vivid(Dice& dice) {
  const int hue = dice.below(180);
  cv::Mat hsv(1, 1, CV_8UC3, Colour(hue, dice.between(120, 230), dice.between(110, 230))), bgr;
  cv::cvtColor(hsv, bgr, cv::COLOR_HSV2BGR);
  const auto& p = bgr.at<cv::Vec3b>(0, 0);
  return {static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2])};
}

void add_grain(cv::Mat& image, Dice& dice, const std::vector<std::pair<int, double>>& grains,
               double stretch_x) {
  cv::Mat sum(image.size(), CV_32F, Colour(0));
  for (const auto& [size, strength] : grains) {
    const int w = std::max(2, static_cast<int>(image.cols / (size * stretch_x))),
              h = std::max(2, image.rows / size);
    cv::Mat coarse(h, w, CV_32F), framed, fine;
    const std::uint32_t key = dice.bits();
    for (int y = 0; y < h; ++y)
      for (int x = 0; x < w; ++x)
        coarse.at<float>(y, x) =
            gaussian(hash(key, static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y)));
    cv::copyMakeBorder(coarse, framed, 1, 1, 1, 1, cv::BORDER_WRAP);
    const cv::Size full(image.cols * (w + 2) / w, image.rows * (h + 2) / h);
    cv::resize(framed, fine, full, 0, 0, cv::INTER_LINEAR);
    sum += strength * fine(cv::Rect(image.cols / w, image.rows / h, image.cols, image.rows));
  }
  cv::Mat wide, colour;
  image.convertTo(wide, CV_32F);
  cv::merge(std::vector<cv::Mat>{sum, sum, sum}, colour);
  wide += colour;
  wide.convertTo(image, CV_8U);
}

std::string nonsense(Dice& dice, int letters) {
  std::string word;
  for (int i = 0; i < letters; ++i) word += static_cast<char>('a' + dice.below(26));
  return word;
}

void write_rows(cv::Mat& image, Dice& dice, const cv::Rect& where, double size, const Colour& ink) {
  const int pitch = std::max(5, static_cast<int>(size * 34));
  for (int y = where.y + pitch; y < where.br().y; y += pitch) {
    if (dice.below(7) == 0) continue;
    int x = where.x + (dice.below(6) == 0 ? where.width / 8 : 0);
    const int end = where.br().x - dice.below(where.width / 4 + 1);
    while (x < end) {
      const std::string word = nonsense(dice, 2 + dice.below(8));
      const int width = cv::getTextSize(word, cv::FONT_HERSHEY_SIMPLEX, size, 1, nullptr).width;
      if (x + width > where.br().x) break;
      cv::putText(image, word, {x, y}, cv::FONT_HERSHEY_SIMPLEX, size, ink, 1, cv::LINE_AA);
      x += width + pitch / 2;
    }
  }
}

void scatter_shapes(cv::Mat image, Dice& dice, int count, int smallest, int largest) {
  for (int i = 0; i < count; ++i) {
    const cv::Point p = random_point(dice, image);
    const int r = smallest + dice.below(largest - smallest + 1), kind = dice.below(4);
    const Colour colour = vivid(dice);
    if (kind == 0) cv::circle(image, p, r, colour, cv::FILLED, cv::LINE_AA);
    if (kind == 1) cv::rectangle(image, p, p + cv::Point(r * 2, r), colour, cv::FILLED);
    if (kind == 2) cv::line(image, p, random_point(dice, image), colour, 1 + r / 6, cv::LINE_AA);
    if (kind == 3)
      cv::ellipse(image, p, {r, r / 2}, dice.between(0, 180), 0, 300, colour, 1 + r / 4, cv::LINE_AA);
  }
}

}  // namespace stillpoint::generated
