#include "core/sequence/generated/act.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/error.hpp"
#include "core/sequence/generated/actors.hpp"

namespace stillpoint::generated {
namespace {

const Vector2d kLeftSeat(-0.78, 1.55), kRightSeat(0.8, 1.52);  // m in the room: before either desk

/// The room with all that stands in it but chairs.
void furnish(Furnisher& f) {
  f.room();
  f.desk({-0.8f, 2.35f}, {1.6f, 0.8f});
  f.desk({0.8f, 2.35f}, {1.6f, 0.8f});
  f.partition();
  f.desk_things();
  f.shelf({-2.55f, 4.32f}, 0, 5);
  f.shelf({-1.5f, 4.32f}, 0, 5);
  f.shelf({-3.12f, 2.3f}, M_PI / 2, 5);
  f.plant({2.75f, 3.9f, 0}, 1.7f);
  // A cabinet with a robot arm and books on it.
  f.box({2.08f, 2.5f, 0.42f}, {0.5f, 0.6f, 0.84f}, 0,
        f.surface(Picture::kMetal, 1.4f, {1.12f, 1.12f, 1.12f}));
  for (const float z : {0.2f, 0.44f, 0.68f})
    f.box({2.08f, 2.19f, z}, {0.18f, 0.03f, 0.02f}, 0, f.plain(50, 50, 50));
  f.robot_arm({2.15f, 2.6f, 0.84f});
  f.books_lying({1.98f, 2.36f, 0.84f}, 4);
  // Parcels, a bin, a bag by the wall.
  f.box({-2.2f, 2.75f, 0.2f}, {0.5f, 0.4f, 0.4f}, 0.3, f.surface(Picture::kCardboard));
  f.box({-2.25f, 2.8f, 0.53f}, {0.38f, 0.32f, 0.26f}, -0.2, f.surface(Picture::kCardboard));
  f.box({2.5f, 1.1f, 0.22f}, {0.44f, 0.5f, 0.44f}, 0.5, f.surface(Picture::kCardboard));
  f.cylinder({-1.85f, 2.05f, 0}, {-1.85f, 2.05f, 0.32f}, 0.14f, f.plain(70, 62, 58));
  f.rod({-0.1f, 2.6f, 0.01f}, {-0.5f, 2.1f, 0.01f}, 0.006f, f.plain(40, 40, 40));
  f.rod({-0.5f, 2.1f, 0.01f}, {-1.4f, 2.3f, 0.01f}, 0.006f, f.plain(40, 40, 40));
  f.box({-0.75f, 2.5f, 0.24f}, {0.2f, 0.45f, 0.44f}, 0.05,
        f.surface(Picture::kMetal, 3, {0.25f, 0.25f, 0.25f}));
}

struct Kind {
  const char* name;
  Handling handling;
  enum { kNobody, kSitting, kWalking, kWorking, kCart, kCup } story;
};

constexpr Kind kKinds[] = {
    {"desk_with_person", Handling::kSweep, Kind::kWorking},
    {"sitting_static", Handling::kStatic, Kind::kSitting},
    {"sitting_xyz", Handling::kXyz, Kind::kSitting},
    {"sitting_rpy", Handling::kRpy, Kind::kSitting},
    {"sitting_halfsphere", Handling::kHalfsphere, Kind::kSitting},
    {"walking_static", Handling::kStatic, Kind::kWalking},
    {"walking_xyz", Handling::kXyz, Kind::kWalking},
    {"walking_rpy", Handling::kRpy, Kind::kWalking},
    {"walking_halfsphere", Handling::kHalfsphere, Kind::kWalking},
    {"room", Handling::kXyz, Kind::kNobody},
    {"approach", Handling::kStatic, Kind::kCart},
    {"cup", Handling::kXyz, Kind::kCup},
};

constexpr Kind kHardKinds[] = {
    {"room_shaken", Handling::kShaken, Kind::kNobody},
    {"walking_shaken", Handling::kShaken, Kind::kWalking},
};

template <std::size_t kCount>
std::vector<std::string> names_of(const Kind (&kinds)[kCount]) {
  std::vector<std::string> names;
  for (const Kind& kind : kinds) names.emplace_back(kind.name);
  return names;
}

const Kind& find_kind(std::string_view name) {
  for (const Kind& kind : kKinds)
    if (name == kind.name) return kind;
  for (const Kind& kind : kHardKinds)
    if (name == kind.name) return kind;
  throw InputError(fmt::format("there is no generated sequence '{}'; the kinds are: {}, {}", name,
                               fmt::join(act_kinds(), ", "), fmt::join(hard_act_kinds(), ", ")));
}

/// Chairs, people and where the camera is.
void stage(const Kind& kind, Furnisher& f, unsigned seed, double seconds, Act& act) {
  const auto chair = [&](const Vector2d& seat, double yaw) { f.chair(seat.cast<float>(), yaw); };
  act.play = [](double, Instant&) {};
  switch (kind.story) {
    case Kind::kSitting: {
      chair(kLeftSeat, 0.62);
      chair(kRightSeat, 2.5);
      const Actor left = sitter(appearance_of(0, f), kLeftSeat, 0.62, kRightSeat, seed + 1);
      const Actor right = sitter(appearance_of(1, f), kRightSeat, 2.5, kLeftSeat, seed + 2);
      act.play = [=](double s, Instant& instant) { left(s, instant), right(s, instant); };
      break;
    }
    case Kind::kWalking:
      chair({-1.25, 1.75}, 1.2);
      chair({0.95, 1.62}, 1.75);
      act.play = walkers(appearance_of(0, f), appearance_of(1, f), seconds, seed + 3);
      break;
    case Kind::kWorking:
      chair({0.75, 1.58}, M_PI / 2);
      chair({-1.1, 1.6}, 1.0);
      act.camera.position = {0.1, 0.25, 1.5};
      act.camera.target = {0.25, 2.25, 0.85};
      act.play = desk_worker(appearance_of(2, f), {0.75, 1.58}, f, seed + 4);
      break;
    case Kind::kCart:
      chair({-1.1, 1.72}, 1.3);
      chair({1.15, 1.7}, 1.9);
      act.camera.position = {0, -1.15, 1.3};
      act.camera.target = {0, 1.2, 1.08};
      act.play = cart_pusher(appearance_of(2, f), f, seed + 5);
      break;
    case Kind::kCup:
      chair({-1.3, 1.6}, 1.2);
      act.camera.position = {0, 1.25, 1.32};
      act.camera.target = {-0.02, 2.3, 0.78};
      act.camera.extent = 0.35;
      act.play = pushed_cup(f, seed + 6);
      break;
    case Kind::kNobody:
      chair(kLeftSeat, 0.9);
      chair(kRightSeat, 2.0);
      break;
  }
}

}  // namespace

const std::vector<std::string>& act_kinds() {
  static const std::vector<std::string> names = names_of(kKinds);
  return names;
}

const std::vector<std::string>& hard_act_kinds() {
  static const std::vector<std::string> names = names_of(kHardKinds);
  return names;
}

Act make_act(std::string_view name, unsigned seed, double seconds) {
  const Kind& kind = find_kind(name);
  Act act;
  constexpr double kDimRoom = 0.025;  // s: by lamplight a camera exposes for most of a frame
  act.camera.handling = kind.handling;
  if (kind.handling == Handling::kShaken) act.exposure = kDimRoom;
  act.scene.pictures = draw_pictures(seed);
  Dice dice(hash(seed, 0xF00Du));
  Furnisher furnisher(act.scene, dice);
  furnish(furnisher);
  stage(kind, furnisher, seed, seconds, act);
  act.scene.planes.push_back(cast_shadows(act.scene.fixed, 0, {-3.3f, -2.7f}, {6.6f, 7.2f}, 0.05f));
  act.scene.planes.push_back(
      cast_shadows(act.scene.fixed, kDeskHeight, {-1.62f, 1.94f}, {3.24f, 0.82f}, 0.02f));
  return act;
}

}  // namespace stillpoint::generated
