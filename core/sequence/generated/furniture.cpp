#include "core/sequence/generated/furniture.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace stillpoint::generated {

Furnisher::Furnisher(Scene& scene, Dice& dice) : scene_(scene), dice_(dice) {
  metal_ = surface(Picture::kMetal, 2);
  white_ = surface(Picture::kPlaster, 2, {1.05f, 1.05f, 1.05f});
  black_ = surface(Picture::kMetal, 3, {0.2f, 0.19f, 0.19f});
  wood_ = surface(Picture::kWood, 1.2f);
  dark_wood_ = surface(Picture::kDarkWood, 1.6f);
  cable_ = plain(38, 36, 36);
}

std::uint16_t Furnisher::surface(Picture picture, float repeats, const Vector3f& tint, bool glows) {
  Surface s;
  s.picture = picture, s.repeats = repeats, s.tint = tint, s.glows = glows;
  if (repeats > 0)
    s.offset = {static_cast<float>(dice_.between(0, 1)), static_cast<float>(dice_.between(0, 1))};
  return scene_.add(s);
}

std::uint16_t Furnisher::plain(float blue, float green, float red) {
  return surface(Picture::kPlain, 0, Vector3f(blue, green, red) / 255.0f);
}

Primitive& Furnisher::box(const Vector3f& centre, const Vector3f& size, double yaw, std::uint16_t surface) {
  return scene_.fixed.emplace_back(make_box(centre, size / 2, turned(yaw), surface));
}

Primitive& Furnisher::rod(const Vector3f& from, const Vector3f& to, float radius, std::uint16_t surface) {
  return scene_.fixed.emplace_back(make_cone(from, radius, to, radius, surface));
}

Primitive& Furnisher::cylinder(const Vector3f& from, const Vector3f& to, float radius,
                               std::uint16_t surface) {
  return scene_.fixed.emplace_back(make_cylinder(from, to, radius, surface));
}

Primitive& Furnisher::ellipsoid(const Vector3f& centre, const Vector3f& radii, double yaw,
                                std::uint16_t surface) {
  return scene_.fixed.emplace_back(make_ellipsoid(centre, radii, turned(yaw), surface));
}

void Furnisher::hang(const Vector3f& centre, float width, float height, double facing,
                     std::uint16_t surface) {
  // The picture is on the box's -y face; the edges are paper white.
  Primitive& p = box(centre, {width, 0.012f, height}, facing + M_PI / 2, white_);
  p.surface[2] = surface;
}

void Furnisher::room() {
  Primitive p =
      make_box({0, 0.9f, 1.4f}, {3.3f, 3.6f, 1.4f}, Matrix3f::Identity(), surface(Picture::kPlaster, 0.55f));
  p.shape = Shape::kRoom;
  p.surface[0] = surface(Picture::kPlaster, 0.55f, {0.94f, 0.99f, 1.0f});
  p.surface[1] = surface(Picture::kPlaster, 0.55f, {0.99f, 0.97f, 0.93f});
  p.surface[4] = surface(Picture::kCarpet, 0.75f);
  p.surface[5] = surface(Picture::kCeiling, 1.6f);
  scene_.fixed.push_back(p);

  for (const float y : {0.2f, 2.4f})  // lamps in the ceiling
    for (const float x : {-1.4f, 1.4f})
      box({x, y, 2.78f}, {0.55f, 1.2f, 0.05f}, 0, surface(Picture::kPlain, 0, {1, 1, 1}, true));
  const std::uint16_t skirting = surface(Picture::kDarkWood, 1);
  box({0, 4.49f, 0.05f}, {6.6f, 0.02f, 0.1f}, 0, skirting);
  box({-3.29f, 0.9f, 0.05f}, {0.02f, 7.2f, 0.1f}, 0, skirting);
  box({3.29f, 0.9f, 0.05f}, {0.02f, 7.2f, 0.1f}, 0, skirting);

  hang({3.28f, 1.9f, 1.55f}, 1.5f, 1.3f, M_PI, surface(Picture::kWindow, 0, {1.05f, 1.05f, 1.05f}, true));
  scene_.fixed.back().dropout = 1.0f;
  box({3.24f, 1.9f, 0.87f}, {0.14f, 1.7f, 0.04f}, 0, white_);
  box({3.2f, 1.9f, 0.45f}, {0.1f, 1.3f, 0.55f}, 0,
      surface(Picture::kKeyboard, 3, {1.1f, 1.1f, 1.1f}));  // radiator
  hang({-0.35f, 4.48f, 1.62f}, 1.7f, 0.95f, -M_PI / 2, surface(Picture::kWhiteboard));
  hang({0.95f, 4.48f, 1.7f}, 0.5f, 0.8f, -M_PI / 2, surface(Picture::kPosterE));
  hang({1.6f, 4.48f, 1.62f}, 0.55f, 0.9f, -M_PI / 2, surface(Picture::kPosterF));
  hang({-3.28f, 0.35f, 1.6f}, 0.6f, 0.95f, 0, surface(Picture::kPosterB));
  hang({-3.28f, 1.15f, 1.65f}, 0.45f, 0.75f, 0, surface(Picture::kPosterD));
  hang({3.28f, 0.2f, 1.6f}, 0.6f, 0.95f, M_PI, surface(Picture::kPosterG));
  hang({3.28f, 3.4f, 1.6f}, 0.5f, 0.8f, M_PI, surface(Picture::kPosterH));
  hang({-1.0f, -2.68f, 1.6f}, 0.6f, 0.95f, M_PI / 2, surface(Picture::kPosterC));
  hang({1.0f, -2.68f, 1.6f}, 0.9f, 1.2f, M_PI / 2, surface(Picture::kPosterB));
  cylinder({2.35f, 4.49f, 2.15f}, {2.35f, 4.45f, 2.15f}, 0.16f, black_);
  cylinder({2.35f, 4.46f, 2.15f}, {2.35f, 4.44f, 2.15f}, 0.14f, white_);
  box({2.35f, 4.435f, 2.19f}, {0.012f, 0.006f, 0.1f}, 0, black_);
  box({2.39f, 4.435f, 2.15f}, {0.08f, 0.006f, 0.012f}, 0, black_);
}

void Furnisher::desk(const Vector2f& centre, const Vector2f& size) {
  box({centre.x(), centre.y(), kDeskHeight - 0.014f}, {size.x() - 0.006f, size.y(), 0.028f}, 0, wood_);
  for (const float x : {-1.0f, 1.0f})
    for (const float y : {-1.0f, 1.0f}) {
      const Vector2f at = centre + Vector2f(x * (size.x() / 2 - 0.05f), y * (size.y() / 2 - 0.05f));
      box({at.x(), at.y(), kDeskHeight / 2 - 0.014f}, {0.05f, 0.05f, kDeskHeight - 0.028f}, 0, metal_);
    }
  box({centre.x(), centre.y() + size.y() / 2 - 0.04f, 0.5f}, {size.x() - 0.16f, 0.02f, 0.36f}, 0, wood_);
}

void Furnisher::partition() {
  const std::uint16_t fabric = surface(Picture::kFabric, 0.9f);
  for (const float x : {-1.2f, 0.0f, 1.2f}) {
    box({x, 2.92f, 0.75f}, {1.16f, 0.035f, 1.36f}, 0, fabric);
    box({x + 0.6f, 2.92f, 0.74f}, {0.04f, 0.05f, 1.46f}, 0, metal_);
    box({x, 2.92f, 1.445f}, {1.2f, 0.045f, 0.03f}, 0, metal_);
  }
  box({-1.8f, 2.92f, 0.74f}, {0.04f, 0.05f, 1.46f}, 0, metal_);
  const float front = 2.896f;
  hang({-1.33f, front, 1.13f}, 0.34f, 0.5f, -M_PI / 2, surface(Picture::kPosterA));
  hang({0.02f, front, 1.15f}, 0.36f, 0.5f, -M_PI / 2, surface(Picture::kPosterD));
  hang({1.45f, front, 1.12f}, 0.34f, 0.48f, -M_PI / 2, surface(Picture::kPosterC));
  const Picture pages[] = {Picture::kPaperA, Picture::kPaperB, Picture::kPaperC};
  for (const auto& [x, z] : {std::pair{-0.35f, 1.2f}, {0.36f, 1.24f}, {-1.0f, 1.22f}, {1.16f, 1.22f}})
    hang({x, front + 0.001f, z}, 0.19f, 0.27f, -M_PI / 2, surface(pages[dice_.below(3)]));
  for (int i = 0; i < 14; ++i) {  // notes
    const float x = static_cast<float>(dice_.between(-1.7, 1.7)),
                z = static_cast<float>(dice_.between(0.95, 1.38));
    const Vector3f colours[] = {{90, 235, 250}, {150, 220, 140}, {190, 150, 245}, {240, 200, 130}};
    const Vector3f& c = colours[dice_.below(4)];
    hang({x, front - 0.004f, z}, 0.07f, 0.07f, -M_PI / 2, plain(c.x(), c.y(), c.z()));
  }
}

void Furnisher::monitor(const Vector3f& foot, double yaw, bool on) {
  const Matrix3f axes = turned(yaw);
  const auto at = [&](float x, float y, float z) -> Vector3f { return foot + axes * Vector3f(x, y, z); };
  cylinder(at(0, 0, 0), at(0, 0, 0.018f), 0.11f, black_);
  box(at(0, 0.03f, 0.09f), {0.05f, 0.03f, 0.17f}, yaw, black_);
  const std::uint16_t frame = on ? black_ : metal_;
  box(at(0, 0.01f, 0.30f), {0.53f, 0.045f, 0.345f}, yaw, frame);
  Primitive& glass = box(at(0, -0.014f, 0.302f), {0.49f, 0.004f, 0.305f}, yaw, frame);
  glass.surface[2] = on ? surface(Picture::kScreen, 0, {1, 1, 1}, true) : plain(38, 34, 33);
  glass.dropout = on ? 0.35f : 0.6f;
}

void Furnisher::chair(const Vector2f& seat, double yaw) {
  const Matrix3f axes = turned(yaw);  // x is where the sitter looks
  const auto at = [&](float x, float y, float z) -> Vector3f {
    return Vector3f(seat.x(), seat.y(), 0) + axes * Vector3f(x, y, z);
  };
  const std::uint16_t shell = surface(Picture::kWood, 1.5f, {0.72f, 0.86f, 0.98f});
  box(at(0.02f, 0, 0.45f), {0.42f, 0.44f, 0.03f}, yaw, shell);
  box(at(-0.21f, 0, 0.74f), {0.025f, 0.4f, 0.3f}, yaw, shell);
  for (const float y : {-0.1f, 0.1f}) rod(at(-0.18f, y, 0.44f), at(-0.225f, y, 0.66f), 0.013f, black_);
  cylinder(at(0, 0, 0.1f), at(0, 0, 0.44f), 0.026f, metal_);
  for (int i = 0; i < 5; ++i) {
    const float a = static_cast<float>(i) * 1.2566f;
    const Vector3f end = at(0.28f * std::cos(a), 0.28f * std::sin(a), 0.07f);
    rod(at(0, 0, 0.11f), end, 0.02f, black_);
    ellipsoid(end - Vector3f(0, 0, 0.035f), {0.03f, 0.03f, 0.03f}, 0, black_);
  }
}

void Furnisher::robot_arm(const Vector3f& foot) {
  const std::uint16_t orange = plain(40, 105, 225);
  const auto at = [&](float x, float y, float z) -> Vector3f { return foot + Vector3f(x, y, z); };
  cylinder(foot, at(0, 0, 0.05f), 0.09f, black_);
  rod(at(0, 0, 0.06f), at(0.02f, 0, 0.16f), 0.055f, orange);
  rod(at(0.02f, 0, 0.18f), at(-0.1f, 0.02f, 0.40f), 0.036f, orange);
  rod(at(-0.1f, 0.02f, 0.40f), at(-0.28f, 0.0f, 0.36f), 0.03f, orange);
  rod(at(-0.28f, 0, 0.36f), at(-0.33f, 0, 0.27f), 0.018f, metal_);
}

}  // namespace stillpoint::generated
