#include "core/sequence/generated/actors.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include "core/sequence/generated/walk.hpp"

namespace stillpoint::generated {
namespace {

double smooth(double x) {
  const double c = std::clamp(x, 0.0, 1.0);
  return c * c * (3 - 2 * c);
}

/// The small motions nobody can help.
struct Restless {
  explicit Restless(unsigned seed) {
    Dice dice(hash(seed, 0x0BEu));
    lean = Wander(dice, 0.035, 0.08, 0.5, 4);
    sway = Wander(dice, 0.03, 0.06, 0.4, 4);
    twist = Wander(dice, 0.06, 0.05, 0.35, 3);
    turn = Wander(dice, 0.22, 0.08, 0.45, 4);
    nod = Wander(dice, 0.08, 0.15, 0.9, 4);
    gate = Wander(dice, 1.0, 0.06, 0.16, 2);
    for (auto& hand : hands)
      for (auto& axis : hand) axis = Wander(dice, 0.075, 0.3, 1.2, 4);
  }
  void apply(double s, FigureState& state) const {
    state.lean += lean.at(s);
    state.sway += sway.at(s);
    state.twist += twist.at(s);
    state.head_turn += turn.at(s);
    state.head_nod += nod.at(s);
  }
  [[nodiscard]] Vector3d hand(std::size_t side, double s) const {
    return {hands[side][0].at(s), hands[side][1].at(s), hands[side][2].at(s)};
  }
  Wander lean, sway, twist, turn, nod, gate;
  std::array<std::array<Wander, 3>, 2> hands;
};

/// A point ahead of, to the left of and above someone's place on the floor.
Vector3d beside(const FigureState& state, double ahead, double left, double up) {
  const double c = std::cos(state.heading), s = std::sin(state.heading);
  return {state.position.x() + c * ahead - s * left, state.position.y() + s * ahead + c * left, up};
}

}  // namespace

FigureLook appearance_of(int who, Furnisher& f) {
  FigureLook look;
  Dice& dice = f.dice();
  const auto shade = static_cast<float>(dice.between(0.9, 1.08));
  look.skin = f.surface(Picture::kSkin, 6, Vector3f(1, 1, 1) * shade);
  look.face = f.surface(Picture::kFace, 0, Vector3f(1, 1, 1) * shade);
  look.height = dice.between(1.72, 1.86);
  look.girth = dice.between(0.97, 1.08);
  if (who == 0) {
    look.shirt = f.surface(Picture::kPlaid, 4.2f, {0.92f, 1.0f, 0.92f});
    look.trousers = f.surface(Picture::kCloth, 5, {0.47f, 0.40f, 0.38f});
    look.hair = f.surface(Picture::kHair, 8, {1.5f, 1.7f, 2.0f});
  } else if (who == 1) {
    look.shirt = f.surface(Picture::kCloth, 4, {0.22f, 0.2f, 0.2f});
    look.trousers = f.surface(Picture::kCloth, 5, {0.42f, 0.62f, 0.72f});
    look.hair = f.surface(Picture::kHair, 8);
  } else {
    look.shirt = f.surface(Picture::kStripes, 5);
    look.trousers = f.surface(Picture::kCloth, 5, {0.55f, 0.34f, 0.25f});
    look.hair = f.surface(Picture::kHair, 8, {0.8f, 0.8f, 0.8f});
    look.long_sleeves = true;
  }
  look.shoes = f.plain(45, 42, 50);
  look.belt = f.plain(28, 36, 48);
  return look;
}

Actor sitter(const FigureLook& look, const Vector2d& seat, double heading, const Vector2d& partner,
             unsigned seed) {
  const Vector2d way = partner - seat;
  const double towards = std::remainder(std::atan2(way.y(), way.x()) - heading, 2 * M_PI);
  return [=, restless = Restless(seed)](double s, Instant& instant) {
    FigureState state;
    state.position = seat;
    state.heading = heading;
    state.sitting = 1;
    state.lean = 0.06;
    // Now and then the head turns to the other one, and a hand underlines what is said.
    const double talk = smooth(0.5 + 1.4 * restless.gate.at(s));
    state.head_turn = std::clamp(towards, -1.0, 1.0) * (0.35 + 0.5 * talk);
    restless.apply(s, state);
    const double active = 0.12 + 0.88 * talk;
    state.hands[1] = {1, beside(state, 0.36, -0.16, 0.72 + 0.22 * talk) + active * restless.hand(1, s)};
    const double other = smooth(0.3 - 1.4 * restless.gate.at(s + 4));
    state.hands[0] = {
        1, beside(state, 0.34, 0.15, 0.71 + 0.14 * other) + (0.08 + 0.5 * other) * restless.hand(0, s)};
    add_figure(look, state, instant);
  };
}

Actor walkers(const FigureLook& first, const FigureLook& second, double seconds, unsigned seed) {
  Dice dice(hash(seed, 0x3A1Cu));
  const auto at = [&](double x, double y) -> Vector2d {
    return {x + dice.between(-0.08, 0.08), y + dice.between(-0.06, 0.06)};
  };
  const auto pause = [&](double s) { return s * dice.between(0.7, 1.4); };
  std::vector<std::vector<Stop>> routes(2);
  routes[0] = {{at(0.3, 1.1)},       {at(-0.75, 1.2), 1.1, pause(1.2), 1.9},
               {at(-1.7, 1.3), 1.0}, {at(-1.2, 0.95), 0.9},
               {at(0.1, 1.0), 1.15}, {at(0.62, 1.35), 0.9, pause(1.6), 1.3},
               {at(1.6, 1.3), 1.1},  {at(1.3, 1.0), 0.9}};
  routes[1] = {{at(-0.55, 1.55), 1.0},
               {at(0.05, 1.45), 1.0, pause(1.0), 1.5},
               {at(0.7, 1.3), 0.9},
               {{0.95, 1.6}, 0.6, 6.0, 1.75, true},
               {at(0.5, 1.15), 0.9},
               {at(-0.6, 1.35), 1.1},
               {at(-1.55, 1.2), 1.1, pause(0.9), 2.4}};
  auto walk = std::make_shared<const Walk>(routes, seconds + 3);
  return [=, a = Restless(seed + 11), b = Restless(seed + 12)](double s, Instant& instant) {
    for (const std::size_t who : {std::size_t{0}, std::size_t{1}}) {
      FigureState state = walk->at(who, s + 2);  // they are on their way when the sequence begins
      state.lean = 0.05 * state.stride;
      (who == 0 ? a : b).apply(s, state);
      // Seated, the hands lie on the table.
      for (const std::size_t side : {std::size_t{0}, std::size_t{1}})
        state.hands[side] = {state.sitting,
                             beside(state, 0.42, side == 0 ? 0.17 : -0.17, 0.8) + 0.3 * a.hand(side, s)};
      add_figure(who == 0 ? first : second, state, instant);
    }
  };
}

namespace {

/// A mug as three solids, standing at `foot`.
void add_mug(const Vector3d& foot, std::uint16_t side, std::uint16_t inside, bool moving, Instant& instant) {
  const Vector3f at = foot.cast<float>();
  const auto add = [&](Primitive p) {
    p.moving = moving;
    instant.actors.push_back(p);
  };
  Primitive body = make_cylinder(at, at + Vector3f(0, 0, 0.095f), 0.042f, side);
  body.surface[1] = inside;
  add(body);
  const Vector3f high = at + Vector3f(0.066f, -0.02f, 0.07f), low = at + Vector3f(0.066f, -0.02f, 0.035f);
  add(make_cone(high, 0.008f, low, 0.008f, side));
  add(make_cone(at + Vector3f(0.035f, -0.01f, 0.078f), 0.008f, high, 0.008f, side));
}

/// Things count as moving above this, here or a frame before or after.
constexpr double kMovingSpeed = 0.005;  // m/s
constexpr double kFramePeriod = 1.0 / 30;

bool is_moving(const std::function<Vector3d(double)>& place, double s) {
  const Vector3d here = place(s);
  return std::max((place(s + kFramePeriod) - here).norm(), (place(s - kFramePeriod) - here).norm()) >
         kMovingSpeed * kFramePeriod;
}

}  // namespace

Actor desk_worker(const FigureLook& look, const Vector2d& seat, Furnisher& f, unsigned seed) {
  const std::uint16_t side = f.surface(Picture::kMug, 0, {1.1f, 0.85f, 0.6f}), inside = f.plain(30, 45, 70);
  const double x = seat.x(), top = static_cast<double>(kDeskHeight) + 0.004;
  const std::array<Vector3d, 4> places = {
      Vector3d(x + 0.34, 2.1, top), {x + 0.12, 2.06, top}, {x + 0.42, 2.03, top}, {x + 0.22, 2.12, top}};
  constexpr double kTurn = 3.4;  // s a mug's journey
  const auto mug = [=](double s) -> Vector3d {
    const double turns = std::max(0.0, s + 1) / kTurn;
    const auto i = static_cast<std::size_t>(turns);
    const double way = smooth((turns - std::floor(turns) - 0.25) / 0.42);
    const Vector3d &from = places[i % 4], &to = places[(i + 1) % 4];
    return from + way * (to - from) + Vector3d(0, 0, 0.35 * way * (1 - way));
  };
  return [=, restless = Restless(seed)](double s, Instant& instant) {
    const double turns = std::max(0.0, s + 1) / kTurn, part = turns - std::floor(turns);
    const double reach = smooth(part / 0.25) * smooth((1 - part) / 0.25);
    FigureState state;
    state.position = seat;
    state.heading = M_PI / 2;
    state.sitting = 1;
    state.lean = 0.16 + 0.05 * reach;
    state.head_nod = 0.25;
    restless.apply(s, state);
    const Vector3d rest = beside(state, 0.42, -0.12, 0.80) + 0.12 * restless.hand(1, s);
    state.hands[1] = {1, rest + reach * (mug(s) + Vector3d(0, -0.08, 0.06) - rest)};
    state.hands[0] = {1, beside(state, 0.43, 0.14, 0.80) + 0.2 * restless.hand(0, s)};
    add_figure(look, state, instant);
    add_mug(mug(s), side, inside, is_moving(mug, s), instant);
  };
}

Actor cart_pusher(const FigureLook& look, Furnisher& f, unsigned seed) {
  const std::uint16_t carton = f.surface(Picture::kCardboard), poster = f.surface(Picture::kPosterH);
  const std::uint16_t steel = f.surface(Picture::kMetal, 2, {0.6f, 0.6f, 0.65f}),
                      rubber = f.plain(35, 35, 38);
  Dice dice(hash(seed, 0xCA27u));
  const double phase = dice.between(0, 2 * M_PI), rate = 2 * M_PI / 8.5;
  const auto place = [=](double s) { return 0.62 + 0.62 * std::cos(rate * s + phase); };  // y, m
  return [=, restless = Restless(seed)](double s, Instant& instant) {
    const auto y = static_cast<float>(place(s));
    const auto add = [&](Primitive p) {
      p.moving = true;
      instant.actors.push_back(p);
    };
    Primitive box = make_box({0, y + 0.22f, 0.97f}, {0.27f, 0.2f, 0.42f}, Matrix3f::Identity(), carton);
    box.surface[2] = poster;
    add(box);
    add(make_box({0, y + 0.22f, 0.52f}, {0.32f, 0.24f, 0.03f}, Matrix3f::Identity(), steel));
    add(make_box({0, y + 0.22f, 0.2f}, {0.32f, 0.24f, 0.015f}, Matrix3f::Identity(), steel));
    for (const float x : {-0.3f, 0.3f})
      for (const float d : {0.0f, 0.44f}) {
        add(make_box({x, y + d, 0.3f}, {0.015f, 0.015f, 0.23f}, Matrix3f::Identity(), steel));
        add(make_cylinder({x - 0.015f, y + d, 0.05f}, {x + 0.015f, y + d, 0.05f}, 0.05f, rubber));
      }
    FigureState state;
    state.position = {0.02, place(s) + 0.85};
    state.heading = -M_PI / 2;
    const double speed = std::abs(place(s + 0.01) - place(s - 0.01)) / 0.02;
    state.stride = std::min(1.0, std::sqrt(speed / 1.15));
    state.stride_phase = -place(s) * 2 * M_PI / 0.95;
    state.lean = 0.12;
    restless.apply(s, state);
    for (const std::size_t i : {std::size_t{0}, std::size_t{1}})
      state.hands[i] = {1, beside(state, 0.42, i == 0 ? 0.22 : -0.22, 1.12)};
    add_figure(look, state, instant);
  };
}

Actor pushed_cup(Furnisher& f, unsigned seed) {
  const std::uint16_t side = f.surface(Picture::kMug, 0, {0.75f, 0.85f, 1.1f}), inside = f.plain(30, 45, 70);
  const std::uint16_t wood = f.surface(Picture::kDarkWood, 3);
  Dice dice(hash(seed, 0xC0Bu));
  const double start = dice.between(0, 4);
  const auto place = [=](double s) -> Vector3d {
    // Four seconds across, a rest, and back.
    const double part = std::fmod(s + start, 9.0);
    const double way = part < 4.5 ? smooth((part - 0.6) / 3.3) : 1 - smooth((part - 5.1) / 3.3);
    return {-0.42 + 0.74 * way, 2.06 + 0.03 * std::sin(4 * way), static_cast<double>(kDeskHeight) + 0.003};
  };
  return [=](double s, Instant& instant) {
    const bool moving = is_moving(place, s);
    add_mug(place(s), side, inside, moving, instant);
    const Vector3f grip = place(s).cast<float>() + Vector3f(0.03f, -0.045f, 0.06f);
    Primitive stick = make_cone(grip, 0.008f, grip + Vector3f(0.42f, -0.66f, 0.3f), 0.011f, wood);
    stick.moving = moving;
    instant.actors.push_back(stick);
  };
}

}  // namespace stillpoint::generated
