#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <string>

#include "core/sequence/generated/random.hpp"
#include "core/sequence/generated/texture.hpp"

namespace stillpoint::generated {
namespace {

using Colour = cv::Scalar;  // BGR

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

/// Adds noise of several grain sizes that repeats at the edges; `strength` in grey levels a grain size.
void add_grain(cv::Mat& image, Dice& dice, const std::vector<std::pair<int, double>>& grains,
               double stretch_x = 1) {
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

/// Rows of words, as on a printed page.
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

cv::Mat carpet(Dice& dice) {
  cv::Mat image = canvas(512, 512, {112, 104, 98});
  add_grain(image, dice, {{2, 13}, {4, 9}, {12, 5}, {64, 4}});
  for (int i = 0; i < 500; ++i) {
    const cv::Point p = random_point(dice, image);
    const double light = dice.between(60, 165);
    cv::circle(image, p, 1 + dice.below(2), {light + 8, light, light - 6}, cv::FILLED);
  }
  for (int k = 0; k < 512; k += 256) {  // carpet tiles
    cv::line(image, {k, 0}, {k, 511}, {78, 72, 68}, 2);
    cv::line(image, {0, k}, {511, k}, {78, 72, 68}, 2);
  }
  return image;
}

cv::Mat wood(Dice& dice, const Colour& colour, double contrast) {
  cv::Mat image = canvas(512, 256, colour);
  add_grain(image, dice, {{2, contrast * 0.8}, {4, contrast}, {10, contrast * 1.2}}, 14);
  add_grain(image, dice, {{2, 2}, {40, 2}});
  for (int i = 0; i < 5; ++i)
    cv::ellipse(image, random_point(dice, image), {10 + dice.below(14), 2 + dice.below(3)}, 0, 0, 360,
                colour * 0.75, 1, cv::LINE_AA);
  return image;
}

cv::Mat ceiling(Dice& dice) {
  cv::Mat image = canvas(256, 256, {212, 216, 218});
  for (int i = 0; i < 700; ++i)
    cv::circle(image, random_point(dice, image), dice.below(2), {176, 180, 182}, cv::FILLED);
  add_grain(image, dice, {{2, 3}, {32, 2}});
  cv::rectangle(image, {0, 0}, {255, 255}, {150, 152, 155}, 5);
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

cv::Mat window(Dice& dice) {
  cv::Mat image = canvas(256, 256, {250, 248, 240});
  cv::rectangle(image, {0, 170}, {255, 255}, {176, 200, 184}, cv::FILLED);
  for (int i = 0; i < 40; ++i)
    cv::circle(image, {dice.below(256), 160 + dice.below(60)}, 8 + dice.below(18),
               {130, 180 + dice.between(0, 30), 150}, cv::FILLED, cv::LINE_AA);
  for (int y = 0; y < 120; y += 9) cv::line(image, {0, y}, {255, y}, {205, 210, 214}, 5);  // blinds
  for (int x : {0, 128, 255}) cv::line(image, {x, 0}, {x, 255}, {190, 190, 190}, 9);
  for (int y : {0, 255}) cv::line(image, {0, y}, {255, y}, {190, 190, 190}, 9);
  return image;
}

cv::Mat plaid(Dice& dice) {
  cv::Mat image = canvas(256, 256, {214, 216, 210});
  cv::Mat lines = canvas(256, 256, {0, 0, 0});
  for (int k = 0; k < 256; k += 64) {
    for (const auto& [at, width, depth] :
         {std::tuple{8, 20, 62.0}, std::tuple{38, 5, 88.0}, std::tuple{52, 3, 70.0}}) {
      const Colour dye(depth * 1.1, depth * 0.72, depth * 1.25);
      cv::Mat across = lines(cv::Rect(0, k + at, 256, width)), down = lines(cv::Rect(k + at, 0, width, 256));
      across += dye;
      down += dye;
    }
  }
  image -= lines;
  add_grain(image, dice, {{2, 5}, {40, 6}});
  return image;
}

cv::Mat stripes(Dice& dice) {
  cv::Mat image = canvas(128, 128, {190, 150, 110});
  for (int y = 0; y < 128; y += 32) {
    cv::rectangle(image, {0, y}, {127, y + 11}, {70, 40, 30}, cv::FILLED);
    cv::line(image, {0, y + 20}, {127, y + 20}, {225, 225, 225}, 3);
  }
  add_grain(image, dice, {{2, 5}, {30, 5}});
  return image;
}

/// A head unrolled: u = 0.5 is the nose, v = 0 the crown.
cv::Mat face(Dice& dice) {
  const Colour skin(138, 168, 212), shade(110, 138, 186), hair(28, 36, 48);
  cv::Mat image = canvas(256, 256, skin);
  add_grain(image, dice, {{3, 3}, {24, 4}});
  cv::ellipse(image, {128, 168}, {34, 22}, 0, 0, 180, {70, 84, 110}, cv::FILLED, cv::LINE_AA);  // beard
  cv::GaussianBlur(image, image, {9, 9}, 0);
  for (int side : {-1, 1}) {
    const cv::Point eye(128 + side * 19, 122);
    cv::ellipse(image, eye, {9, 5}, 0, 0, 360, {235, 238, 240}, cv::FILLED, cv::LINE_AA);
    cv::circle(image, eye, 4, {50, 60, 70}, cv::FILLED, cv::LINE_AA);
    cv::ellipse(image, eye, {10, 6}, 0, 180, 360, {40, 50, 70}, 2, cv::LINE_AA);
    cv::ellipse(image, eye + cv::Point(0, -9), {13, 5}, 0, 195, 345, hair, 4, cv::LINE_AA);
    cv::circle(image, {128 + side * 62, 130}, 9, shade, cv::FILLED, cv::LINE_AA);  // ear
  }
  cv::line(image, {128, 118}, {125, 140}, shade, 3, cv::LINE_AA);
  cv::ellipse(image, {128, 143}, {9, 4}, 0, 0, 180, shade * 0.9, 2, cv::LINE_AA);
  cv::ellipse(image, {128, 160}, {14, 4}, 0, 0, 360, {92, 96, 160}, cv::FILLED, cv::LINE_AA);
  cv::line(image, {114, 160}, {142, 160}, {60, 60, 100}, 1, cv::LINE_AA);
  cv::rectangle(image, {0, 0}, {255, 86}, hair, cv::FILLED);
  cv::rectangle(image, {0, 0}, {58, 178}, hair, cv::FILLED);
  cv::rectangle(image, {198, 0}, {255, 178}, hair, cv::FILLED);
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

cv::Mat grained(Dice& dice, int side, const Colour& colour, const std::vector<std::pair<int, double>>& grains,
                double stretch = 1) {
  cv::Mat image = canvas(side, side, colour);
  add_grain(image, dice, grains, stretch);
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

cv::Mat draw(Picture which, Dice& dice) {
  switch (which) {
    case Picture::kCarpet:
      return carpet(dice);
    case Picture::kPlaster:
      return grained(dice, 512, {206, 212, 214}, {{2, 3}, {5, 2.5}, {24, 2.5}, {128, 4}});
    case Picture::kCeiling:
      return ceiling(dice);
    case Picture::kFabric:
      return grained(dice, 512, {112, 142, 166}, {{2, 8}, {4, 5}, {16, 3}, {128, 3}});
    case Picture::kWood:
      return wood(dice, {168, 200, 218}, 5);
    case Picture::kDarkWood:
      return wood(dice, {62, 96, 138}, 9);
    case Picture::kMetal:
      return grained(dice, 128, {150, 152, 152}, {{2, 3}, {24, 4}}, 4);
    case Picture::kPaper:
      return page(dice);
    case Picture::kKeyboard:
      return keyboard(dice);
    case Picture::kScreen:
      return screen(dice);
    case Picture::kWhiteboard:
      return whiteboard(dice);
    case Picture::kCardboard:
      return cardboard(dice);
    case Picture::kSpineA:
      return spine(dice, 0);
    case Picture::kSpineB:
      return spine(dice, 1);
    case Picture::kSpineC:
      return spine(dice, 2);
    case Picture::kPosterA:
      return poster(dice, 0);
    case Picture::kPosterB:
      return poster(dice, 1);
    case Picture::kPosterC:
      return poster(dice, 2);
    case Picture::kPosterD:
      return poster(dice, 3);
    case Picture::kCover:
      return cover(dice);
    case Picture::kWindow:
      return window(dice);
    case Picture::kPlaid:
      return plaid(dice);
    case Picture::kStripes:
      return stripes(dice);
    case Picture::kCloth:
      return grained(dice, 128, {200, 200, 200}, {{2, 7}, {6, 5}, {40, 9}});
    case Picture::kSkin:
      return grained(dice, 64, {150, 178, 222}, {{2, 3}, {16, 5}});
    case Picture::kFace:
      return face(dice);
    case Picture::kHair:
      return grained(dice, 128, {34, 44, 58}, {{2, 8}, {8, 7}});
    case Picture::kLeaf:
      return grained(dice, 64, {62, 128, 74}, {{2, 8}, {12, 14}}, 3);
    case Picture::kMug:
      return mug(dice);
    case Picture::kPlain:
    case Picture::kCount:
      break;
  }
  return canvas(8, 8, {255, 255, 255});
}

}  // namespace

std::vector<Texture> draw_pictures(unsigned seed) {
  std::vector<Texture> pictures;
  for (int i = 0; i < static_cast<int>(Picture::kCount); ++i) {
    Dice dice(hash(seed, static_cast<std::uint32_t>(i), 0x7e87u));
    pictures.emplace_back(draw(static_cast<Picture>(i), dice));
  }
  return pictures;
}

}  // namespace stillpoint::generated
