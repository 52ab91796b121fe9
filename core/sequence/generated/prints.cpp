#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "core/sequence/generated/drawing.hpp"

namespace stillpoint::generated {

cv::Mat poster(Dice& dice, int style) {
  const bool dark = style % 2 == 1;
  cv::Mat image = canvas(256, 512, dark ? Colour(90, 50, 30) : Colour(225, 235, 240));
  const Colour ink = dark ? Colour(235, 240, 245) : Colour(40, 30, 30);
  cv::rectangle(image, {0, 0}, {255, 60}, vivid(dice), cv::FILLED);
  cv::putText(image, nonsense(dice, 7), {14, 42}, cv::FONT_HERSHEY_DUPLEX, 1.3, {250, 250, 250}, 3,
              cv::LINE_AA);
  cv::Mat picture = image(cv::Rect(16, 78, 224, 190));
  picture.setTo(vivid(dice));
  scatter_shapes(picture, dice, 42, 4, 40);
  cv::rectangle(image, {16, 78}, {240, 268}, ink, 2);
  write_rows(image, dice, {16, 276, 105, 140}, 0.32, ink);
  write_rows(image, dice, {134, 276, 106, 140}, 0.32, ink);
  cv::Mat figure = image(cv::Rect(16, 424, 224, 72));
  figure.setTo(Colour(245, 245, 245));
  for (int i = 0; i < 14; ++i)
    cv::rectangle(figure, {6 + i * 15, 68}, {16 + i * 15, 66 - dice.below(56)}, vivid(dice), cv::FILLED);
  cv::rectangle(image, {0, 0}, {255, 511}, ink, 3);
  add_grain(image, dice, {{2, 3}, {32, 3}});
  return image;
}

cv::Mat spine(Dice& dice, int style) {
  cv::Mat image = canvas(64, 256, {205, 205, 205});  // light: books tint it
  cv::Mat lying = canvas(256, 64, {205, 205, 205});
  cv::putText(lying, nonsense(dice, 9), {24, 42},
              style == 1 ? cv::FONT_HERSHEY_TRIPLEX : cv::FONT_HERSHEY_DUPLEX, 0.9,
              style == 2 ? Colour(20, 20, 20) : Colour(255, 255, 255), 2, cv::LINE_AA);
  cv::rotate(lying, image, cv::ROTATE_90_CLOCKWISE);
  for (int i = 0; i < 3 + style; ++i) {
    const int y = dice.below(2) == 0 ? dice.below(30) : 225 + dice.below(28);
    cv::line(image, {0, y}, {63, y}, style == 0 ? Colour(40, 180, 230) : Colour(60, 60, 60),
             2 + dice.below(4));
  }
  if (style == 2) cv::rectangle(image, {6, 190}, {58, 222}, {250, 250, 250}, cv::FILLED);
  if (style == 2) write_rows(image, dice, {10, 190, 46, 30}, 0.3, {30, 30, 30});
  cv::rectangle(image, {0, 0}, {63, 255}, {120, 120, 120}, 2);
  add_grain(image, dice, {{2, 4}, {16, 5}});
  return image;
}

cv::Mat keyboard(Dice& dice) {
  cv::Mat image = canvas(512, 128, {46, 44, 44});
  for (int row = 0; row < 5; ++row)
    for (int x = 6, key = 0; x < 500; ++key) {
      const int width = row == 4 && key == 3 ? 150 : (key % 14 == 13 ? 42 : 24);
      cv::rectangle(image, {x, 6 + row * 24}, {std::min(506, x + width - 4), 25 + row * 24}, {196, 200, 202},
                    cv::FILLED);
      cv::putText(image, nonsense(dice, 1), {x + 5, 20 + row * 24}, cv::FONT_HERSHEY_PLAIN, 0.9, {30, 30, 30},
                  1, cv::LINE_AA);
      x += width;
    }
  return image;
}

cv::Mat screen(Dice& dice) {
  cv::Mat image = canvas(512, 256, {52, 40, 34});
  cv::rectangle(image, {0, 0}, {511, 18}, {120, 110, 105}, cv::FILLED);
  cv::rectangle(image, {0, 19}, {90, 255}, {70, 58, 50}, cv::FILLED);
  write_rows(image, dice, {6, 22, 80, 230}, 0.3, {190, 190, 190});
  const Colour inks[] = {{140, 230, 150}, {235, 210, 150}, {130, 190, 250}, {220, 220, 220}};
  for (int block = 0; block < 6; ++block)
    write_rows(image, dice, {100 + dice.below(50), 20 + block * 38, 300, 38}, 0.34, inks[dice.below(4)]);
  return image;
}

cv::Mat whiteboard(Dice& dice) {
  cv::Mat image = canvas(512, 256, {236, 238, 238});
  const Colour pens[] = {{170, 70, 40}, {50, 50, 200}, {60, 130, 40}, {40, 40, 40}};
  for (int i = 0; i < 9; ++i)
    cv::putText(image, nonsense(dice, 3 + dice.below(7)), {10 + dice.below(330), 24 + i * 26},
                cv::FONT_HERSHEY_SCRIPT_SIMPLEX, dice.between(0.7, 1.1), pens[dice.below(4)], 2, cv::LINE_AA);
  for (int i = 0; i < 10; ++i) {
    const cv::Point p = {260 + dice.below(200), 20 + dice.below(190)},
                    q = {20 + dice.below(60), 14 + dice.below(26)};
    const Colour pen = pens[dice.below(4)];
    if (i % 3 == 0) cv::rectangle(image, p, p + q, pen, 2, cv::LINE_AA);
    if (i % 3 == 1) cv::ellipse(image, p, {q.x / 2, q.y / 2}, 0, 0, 360, pen, 2, cv::LINE_AA);
    if (i % 3 == 2) cv::arrowedLine(image, p, p + q, pen, 2, cv::LINE_AA, 0, 0.2);
  }
  cv::rectangle(image, {0, 0}, {511, 255}, {150, 150, 150}, 7);
  add_grain(image, dice, {{64, 3}});
  return image;
}

cv::Mat cardboard(Dice& dice) {
  cv::Mat image = canvas(256, 256, {96, 140, 178});
  add_grain(image, dice, {{2, 4}, {8, 3}, {50, 5}});
  cv::rectangle(image, {0, 112}, {255, 144}, {120, 168, 200}, cv::FILLED);
  cv::putText(image, nonsense(dice, 5), {20, 84}, cv::FONT_HERSHEY_DUPLEX, 1.8, {40, 50, 70}, 4, cv::LINE_AA);
  cv::rectangle(image, {140, 164}, {240, 238}, {235, 238, 240}, cv::FILLED);
  write_rows(image, dice, {146, 164, 88, 70}, 0.34, {30, 30, 30});
  for (int i = 0; i < 26; ++i)
    cv::line(image, {20 + i * 4, 180}, {20 + i * 4, 226}, {40, 40, 50}, 1 + dice.below(2));
  return image;
}

cv::Mat cover(Dice& dice) {
  cv::Mat image = canvas(128, 128, vivid(dice));
  scatter_shapes(image, dice, 12, 4, 24);
  cv::rectangle(image, {8, 10}, {119, 46}, {240, 240, 240}, cv::FILLED);
  cv::putText(image, nonsense(dice, 6), {12, 38}, cv::FONT_HERSHEY_DUPLEX, 0.9, {40, 30, 30}, 2, cv::LINE_AA);
  return image;
}

cv::Mat page(Dice& dice) {
  cv::Mat image = canvas(128, 256, {240, 242, 242});
  cv::putText(image, nonsense(dice, 7), {14, 26}, cv::FONT_HERSHEY_DUPLEX, 0.7, {30, 30, 30}, 2, cv::LINE_AA);
  write_rows(image, dice, {12, 32, 104, 130}, 0.3, {50, 50, 50});
  cv::Mat figure = image(cv::Rect(20, 168, 88, 50));
  scatter_shapes(figure, dice, 8, 3, 16);
  write_rows(image, dice, {12, 220, 104, 30}, 0.3, {50, 50, 50});
  return image;
}

cv::Mat mug(Dice& dice) {
  cv::Mat image = canvas(256, 128, {228, 232, 235});
  scatter_shapes(image(cv::Rect(20, 20, 220, 84)), dice, 22, 4, 16);
  cv::line(image, {0, 10}, {255, 10}, {60, 60, 160}, 4);
  cv::putText(image, nonsense(dice, 5), {60, 76}, cv::FONT_HERSHEY_DUPLEX, 1.2, {40, 30, 120}, 3,
              cv::LINE_AA);
  return image;
}

}  // namespace stillpoint::generated
