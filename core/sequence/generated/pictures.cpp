#include <opencv2/imgproc.hpp>

#include "core/sequence/generated/drawing.hpp"
#include "core/sequence/generated/texture.hpp"

namespace stillpoint::generated {
namespace {

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
  cv::ellipse(image, {128, 200}, {38, 36}, 0, 0, 360, {104, 126, 164}, cv::FILLED, cv::LINE_AA);  // stubble
  cv::GaussianBlur(image, image, {9, 9}, 0);
  for (int side : {-1, 1}) {
    const cv::Point eye(128 + side * 19, 122);
    cv::ellipse(image, eye, {9, 5}, 0, 0, 360, {235, 238, 240}, cv::FILLED, cv::LINE_AA);
    cv::circle(image, eye, 4, {50, 60, 70}, cv::FILLED, cv::LINE_AA);
    cv::ellipse(image, eye, {10, 6}, 0, 180, 360, {40, 50, 70}, 2, cv::LINE_AA);
    cv::ellipse(image, eye + cv::Point(0, -9), {13, 5}, 0, 195, 345, hair, 4, cv::LINE_AA);
    cv::circle(image, {128 + side * 62, 130}, 9, shade, cv::FILLED, cv::LINE_AA);  // ear
  }
  cv::line(image, {128, 118}, {125, 148}, shade, 3, cv::LINE_AA);
  cv::ellipse(image, {128, 150}, {9, 4}, 0, 0, 180, shade * 0.9, 2, cv::LINE_AA);
  cv::ellipse(image, {128, 174}, {13, 4}, 0, 0, 360, {92, 96, 160}, cv::FILLED, cv::LINE_AA);
  cv::line(image, {115, 174}, {141, 174}, {60, 60, 100}, 1, cv::LINE_AA);
  cv::rectangle(image, {0, 0}, {255, 86}, hair, cv::FILLED);
  cv::rectangle(image, {0, 0}, {58, 178}, hair, cv::FILLED);
  cv::rectangle(image, {198, 0}, {255, 178}, hair, cv::FILLED);
  return image;
}

cv::Mat grained(Dice& dice, int side, const Colour& colour, const std::vector<std::pair<int, double>>& grains,
                double stretch = 1) {
  cv::Mat image = canvas(side, side, colour);
  add_grain(image, dice, grains, stretch);
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
    case Picture::kPaperA:
    case Picture::kPaperB:
    case Picture::kPaperC:
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
    case Picture::kPosterE:
      return poster(dice, 0);
    case Picture::kPosterF:
      return poster(dice, 1);
    case Picture::kPosterG:
      return poster(dice, 2);
    case Picture::kPosterH:
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
