#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "core/sequence/generated/furniture.hpp"

namespace stillpoint::generated {
namespace {

Vector3f book_colour(Dice& dice) {
  const Vector3f colours[] = {{60, 60, 200},   {190, 110, 40}, {70, 150, 60},   {40, 150, 230},
                              {150, 60, 120},  {60, 60, 70},   {220, 225, 230}, {150, 140, 40},
                              {120, 170, 220}, {90, 40, 40},   {200, 180, 90}};
  return colours[dice.below(11)] / 205.0f * static_cast<float>(dice.between(0.85, 1.15));
}

}  // namespace

void Furnisher::spines(const Vector3f& from, const Vector3f& along, double yaw, float length, float tallest) {
  const Picture pictures[] = {Picture::kSpineA, Picture::kSpineB, Picture::kSpineC};
  float x = 0.01f;
  while (x < length - 0.06f) {
    if (dice_.below(14) == 0) {  // a gap between books
      x += 0.09f;
      continue;
    }
    const float thick = static_cast<float>(dice_.between(0.022, 0.062));
    const float height = tallest * static_cast<float>(dice_.between(0.68, 0.97));
    const float deep = static_cast<float>(dice_.between(0.17, 0.22));
    const Vector3f back = turned(yaw) * Vector3f(0, 0.11f - deep / 2, 0);
    box(from + along * (x + thick / 2) + back + Vector3f(0, 0, height / 2), {thick - 0.002f, deep, height},
        yaw, surface(pictures[dice_.below(3)], 0, book_colour(dice_)));
    x += thick;
  }
}

void Furnisher::shelf(const Vector2f& centre, double yaw, int boards) {
  const Matrix3f axes = turned(yaw);  // the open side is its -y
  const auto at = [&](float x, float y, float z) -> Vector3f {
    return Vector3f(centre.x(), centre.y(), 0) + axes * Vector3f(x, y, z);
  };
  const float width = 1.0f, pitch = 0.37f, top = pitch * static_cast<float>(boards) + 0.08f;
  box(at(0, 0.15f, top / 2), {width, 0.01f, top}, yaw, dark_wood_);
  for (const float x : {-0.5f, 0.5f}) box(at(x, 0, top / 2), {0.022f, 0.3f, top}, yaw, dark_wood_);
  for (int i = 0; i <= boards; ++i) {
    const float z = 0.07f + pitch * static_cast<float>(i);
    box(at(0, 0, z), {width, 0.3f, 0.02f}, yaw, dark_wood_);
    if (i == boards) break;
    if (i == 0) {
      for (const float x : {-0.24f, 0.24f})
        box(at(x, 0, z + 0.15f), {0.4f, 0.26f, 0.28f}, yaw, surface(Picture::kCardboard));
    } else {
      spines(at(-0.48f, 0, z + 0.01f), axes.col(0), yaw, 0.96f, pitch - 0.05f);
    }
  }
}

void Furnisher::plant(const Vector3f& foot, float height) {
  const float pot = 0.32f * height;
  scene_.fixed.push_back(make_cone(foot + Vector3f(0, 0, 0.1f * height), 0.11f * height,
                                   foot + Vector3f(0, 0, pot), 0.15f * height, plain(60, 90, 165)));
  const Vector3f crown = foot + Vector3f(0, 0, pot + 0.15f * height);
  rod(foot + Vector3f(0, 0, pot), crown, 0.02f * height, dark_wood_);
  for (int i = 0; i < 26; ++i) {
    const double around = i * 2.4, rise = dice_.between(-0.1, 1.35);
    const Vector3f out(static_cast<float>(std::cos(around) * std::cos(rise)),
                       static_cast<float>(std::sin(around) * std::cos(rise)),
                       static_cast<float>(std::sin(rise)));
    const float length = height * static_cast<float>(dice_.between(0.2, 0.48));
    Matrix3f axes;
    axes.col(0) = out;
    axes.col(1) = out.cross(Vector3f::UnitZ()).normalized();
    axes.col(2) = axes.col(0).cross(axes.col(1));
    const float shade = static_cast<float>(dice_.between(0.7, 1.2));
    scene_.fixed.push_back(make_ellipsoid(crown + out * length * 0.55f, {length / 2, 0.045f * height, 0.006f},
                                          axes, surface(Picture::kLeaf, 0, {shade, shade, shade})));
  }
}

void Furnisher::mug(const Vector3f& foot, const Vector3f& tint) {
  Primitive& body = cylinder(foot, foot + Vector3f(0, 0, 0.095f), 0.041f, surface(Picture::kMug, 0, tint));
  body.surface[1] = plain(30, 45, 70);  // coffee
  const Vector3f side(0.062f, 0, 0);
  rod(foot + Vector3f(0.04f, 0, 0.075f), foot + side + Vector3f(0, 0, 0.065f), 0.007f, body.surface[0]);
  rod(foot + side + Vector3f(0, 0, 0.065f), foot + side + Vector3f(0, 0, 0.035f), 0.007f, white_);
  rod(foot + side + Vector3f(0, 0, 0.035f), foot + Vector3f(0.04f, 0, 0.025f), 0.007f, white_);
}

void Furnisher::books_lying(const Vector3f& foot, int count) {
  float z = foot.z();
  for (int i = 0; i < count; ++i) {
    const float thick = static_cast<float>(dice_.between(0.02, 0.05));
    const Vector3f colour = book_colour(dice_);
    Primitive& book = box({foot.x(), foot.y(), z + thick / 2}, {0.17f, 0.24f, thick},
                          dice_.between(-0.4, 0.4), plain(222, 228, 230));
    book.surface[5] = surface(Picture::kCover, 0, (colour + Vector3f(1, 1, 1)) / 2);
    book.surface[2] = surface(Picture::kPlain, 0, colour * 0.8f);
    z += thick;
  }
}

void Furnisher::desk_things() {
  const float top = kDeskHeight;
  const std::uint16_t keys = surface(Picture::kKeyboard);
  const std::uint16_t pages[] = {surface(Picture::kPaperA), surface(Picture::kPaperB),
                                 surface(Picture::kPaperC)};
  monitor({-0.95f, 2.58f, top}, 0.12, false);
  monitor({0.72f, 2.6f, top}, -0.1, true);
  for (const auto& [x, yaw] : {std::pair{-0.95f, 0.06}, {0.7f, -0.08}}) {
    Primitive& keyboard = box({x, 2.27f, top + 0.012f}, {0.44f, 0.15f, 0.022f}, yaw, black_);
    keyboard.surface[5] = keys;
    ellipsoid({x + 0.32f, 2.26f, top + 0.012f}, {0.03f, 0.055f, 0.02f}, yaw, black_);
    rod({x + 0.32f, 2.31f, top + 0.006f}, {x + 0.2f, 2.56f, top + 0.006f}, 0.004f, cable_);
  }
  for (int i = 0; i < 7; ++i) {  // papers, each a little above the last so that none coincide
    const float x = static_cast<float>(i < 4 ? -0.32 + 0.13 * i : -1.5 + 0.14 * (i - 4));
    const float y = static_cast<float>(dice_.between(2.22, 2.5)),
                z = top + 0.001f + 0.0012f * static_cast<float>(i);
    box({x, y, z}, {0.21f, 0.297f, 0.001f}, dice_.between(-0.6, 0.6), pages[i % 3]);
  }
  books_lying({-0.42f, 2.62f, top}, 4);
  books_lying({0.24f, 2.66f, top}, 3);
  books_lying({1.32f, 2.55f, top}, 5);
  mug({-0.5f, 2.36f, top}, {1, 1, 1});
  mug({1.15f, 2.3f, top}, {0.6f, 0.75f, 1.05f});
  cylinder({0.15f, 2.42f, top}, {0.15f, 2.42f, top + 0.1f}, 0.038f, black_);
  for (int i = 0; i < 6; ++i) {  // pens
    const float a = static_cast<float>(i) * 1.05f, c = 0.02f * std::cos(a), s = 0.02f * std::sin(a);
    const Vector3f colour = book_colour(dice_) * 200;
    rod({0.15f + c, 2.42f + s, top + 0.05f}, {0.15f + 2.2f * c, 2.42f + 2.2f * s, top + 0.16f}, 0.005f,
        plain(colour.x(), colour.y(), colour.z()));
  }
  Primitive& bottle = cylinder({1.1f, 2.56f, top}, {1.1f, 2.56f, top + 0.17f}, 0.035f,
                               surface(Picture::kMug, 0, {0.7f, 1, 0.7f}));
  bottle.dropout = 0.45f;
  scene_.fixed.push_back(make_cone({1.1f, 2.56f, top + 0.16f}, 0.034f, {1.1f, 2.56f, top + 0.235f}, 0.012f,
                                   plain(120, 190, 110)));
  Primitive& phone = box({-1.5f, 2.62f, top + 0.03f}, {0.2f, 0.21f, 0.05f}, 0.3, black_);
  phone.surface[5] = surface(Picture::kKeyboard, 4);
  rod({-1.57f, 2.54f, top + 0.075f}, {-1.55f, 2.72f, top + 0.075f}, 0.022f, black_);
  // A lamp on two arms.
  cylinder({-0.1f, 2.78f, top}, {-0.1f, 2.78f, top + 0.02f}, 0.08f, metal_);
  rod({-0.1f, 2.78f, top + 0.02f}, {-0.16f, 2.76f, top + 0.36f}, 0.01f, metal_);
  rod({-0.16f, 2.76f, top + 0.36f}, {0.08f, 2.6f, top + 0.5f}, 0.01f, metal_);
  scene_.fixed.push_back(
      make_cone({0.08f, 2.6f, top + 0.51f}, 0.035f, {0.13f, 2.56f, top + 0.45f}, 0.07f, plain(60, 60, 190)));
  plant({1.5f, 2.72f, top}, 0.42f);
  box({0.42f, 2.3f, top + 0.05f}, {0.13f, 0.09f, 0.1f}, 0.5, surface(Picture::kCover));
  box({-0.72f, 2.14f, top + 0.012f}, {0.09f, 0.13f, 0.022f}, -0.4,
      surface(Picture::kCover, 0, {0.8f, 1.1f, 0.9f}));
}

}  // namespace stillpoint::generated
