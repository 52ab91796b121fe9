#include "tests/support/street_scene.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "core/sequence/generated/furniture.hpp"
#include "core/sequence/generated/ray_caster.hpp"
#include "core/sequence/generated/sensor.hpp"
#include "core/sequence/stereo/stereo_matcher.hpp"

namespace stillpoint::testing {
namespace {

using namespace generated;

constexpr unsigned kSeed = 7;
constexpr double kRate = 10.0, kSpeed = 10.0;  // Hz, m/s
constexpr double kEyes = 1.65;                 // m above the road
constexpr float kFar = 160.0F;                 // m, to where the street is built

Camera street_camera(double scale) {
  Camera camera;
  camera.name = "street";
  camera.width = 1241, camera.height = 376;
  camera.fx = camera.fy = 718.856, camera.cx = 607.1928, camera.cy = 185.2157;
  camera.baseline_m = 0.537;
  return camera.scaled_to(static_cast<int>(scale * 1241), static_cast<int>(scale * 376));
}

/// House fronts, with pictures for windows and doors.
void build_houses(Furnisher& f, Dice& dice) {
  constexpr std::array kFronts = {Picture::kCardboard, Picture::kFabric, Picture::kPlaid, Picture::kWood};
  constexpr std::array kOpenings = {Picture::kWindow,  Picture::kPosterA, Picture::kPosterB,
                                    Picture::kPosterE, Picture::kPosterG, Picture::kDarkWood};
  for (const float side : {-1.0F, 1.0F})
    for (float y = -12.0F; y < kFar;) {
      const auto length = static_cast<float>(dice.between(8, 15)),
                 height = static_cast<float>(dice.between(5, 11)),
                 set_back = static_cast<float>(dice.between(9, 12));
      const float tint = static_cast<float>(dice.between(0.6, 1.1));
      f.box({side * (set_back + 4.0F), y + length / 2, height / 2}, {8.0F, length, height}, 0,
            f.surface(kFronts[static_cast<std::size_t>(dice.below(4))], 0.35F, {tint, tint, tint}));
      for (float at = y + 1.0F; at + 1.5F < y + length; at += 2.4F)
        for (float storey = 1.6F; storey + 1.0F < height; storey += 2.9F)
          f.box({side * (set_back - 0.02F), at + 0.6F, storey}, {0.08F, 1.2F, 1.4F}, 0,
                f.surface(kOpenings[static_cast<std::size_t>(dice.below(6))]));
      y += length + static_cast<float>(dice.between(0, 3));
    }
}

void build_roadside(Furnisher& f, Dice& dice) {
  for (const float side : {-1.0F, 1.0F})
    for (float y = 2.0F; y < kFar; y += static_cast<float>(dice.between(6, 11))) {
      const float x = side * 4.6F;
      const float shade = static_cast<float>(dice.between(0.25, 1.1));
      if (dice.below(3) > 0) {
        f.box({x, y, 0.65F}, {1.75F, 4.2F, 0.8F}, 0,
              f.surface(Picture::kMetal, 0.9F, {shade, 0.8F * shade, shade}));
        f.box({x, y - 0.2F, 1.2F}, {1.6F, 2.2F, 0.55F}, 0, f.surface(Picture::kScreen, 0.4F));
        for (const float wheel : {-1.3F, 1.3F})
          f.cylinder({x - side * 0.9F, y + wheel, 0.32F}, {x - side * 0.7F, y + wheel, 0.32F}, 0.32F,
                     f.plain(30, 30, 30));
      } else {
        f.cylinder({side * 6.6F, y, 0.0F}, {side * 6.6F, y, 2.6F}, 0.16F, f.surface(Picture::kDarkWood, 2));
        f.ellipsoid({side * 6.6F, y, 3.6F}, {1.3F, 1.3F, 1.5F}, dice.between(0, 3),
                    f.surface(Picture::kLeaf, 1.0F));
      }
      f.rod({side * 6.0F, y + 3.0F, 0.0F}, {side * 6.0F, y + 3.0F, 4.5F}, 0.06F, f.plain(90, 92, 96));
      f.hang({side * 6.0F, y + 2.93F, 2.6F}, 0.6F, 0.6F, -M_PI / 2, f.surface(Picture::kPosterC));
    }
}

Scene build_street() {
  Scene scene;
  scene.pictures = draw_pictures(kSeed);
  Dice dice(hash(kSeed, 0x57u));
  Furnisher f(scene, dice);
  // The generator's worlds are boxes seen from inside: this one's lid is the sky.
  Primitive world = make_box({0, 60, 20}, {90, 180, 20}, Matrix3f::Identity(),
                             f.surface(Picture::kPlain, 0, {0.9F, 0.85F, 0.8F}, true));
  world.shape = Shape::kRoom;
  world.surface[4] = f.surface(Picture::kCarpet, 0.3F, {0.9F, 0.9F, 0.9F});
  scene.fixed.push_back(world);
  build_houses(f, dice);
  build_roadside(f, dice);
  return scene;
}

class Street final : public FrameSource {
 public:
  Street(int frames, double scale, const StereoOptions& stereo)
      : scene_(build_street()),
        matcher_(street_camera(scale), stereo),
        frames_(frames),
        left_sensor_(kSeed),
        right_sensor_(kSeed + 1) {
    for (int i = 0; i < frames; ++i) ground_truth_.push_back({timestamp(i), world_from_camera(i)});
    Surface paint;
    paint.picture = Picture::kPosterD;
    car_ = make_box({0, 0, 0.7F}, {0.9F, 2.1F, 0.7F}, Matrix3f::Identity(), scene_.add(paint));
    car_.moving = true;
  }

  [[nodiscard]] const std::string& name() const override { return name_; }
  [[nodiscard]] const Camera& camera() const override { return matcher_.camera(); }
  [[nodiscard]] int size() const override { return frames_; }
  [[nodiscard]] double timestamp(int index) const override { return index / kRate; }
  [[nodiscard]] const Trajectory& ground_truth() const override { return ground_truth_; }
  [[nodiscard]] bool has_depth() const override { return true; }
  [[nodiscard]] bool has_masks() const override { return false; }
  [[nodiscard]] const std::vector<std::string>& warnings() const override { return warnings_; }
  [[nodiscard]] Frame read(int index) const override {
    Frame frame;
    frame.index = index;
    frame.timestamp = timestamp(index);
    frame.colour = left_sensor_.colour(seen(index, 0.0).colour, index, timestamp(index));
    cv::cvtColor(frame.colour, frame.gray, cv::COLOR_BGR2GRAY);
    matcher_.match(frame,
                   right_sensor_.colour(seen(index, camera().baseline_m).colour, index, timestamp(index)));
    return frame;
  }
  [[nodiscard]] FrameTruth truth(int index) const override {
    FrameTruth truth;
    truth.world_from_camera = world_from_camera(index);
    truth.depth = cast_depth(scene_, camera(), instant(index, 0.0)).depth;
    return truth;
  }

 private:
  [[nodiscard]] static Pose world_from_camera(int index) {
    // A slight curve, and what the road does to a car.
    const double s = index / kRate, turn = 0.04 * std::sin(0.5 * s), nod = 0.003 * std::sin(9.0 * s);
    Pose pose = Pose::Identity();
    pose.linear() << 1, 0, 0, 0, 0, 1, 0, -1, 0;
    pose.linear() = pose.linear() * so3_exp({nod, turn, 0.002 * std::sin(7.0 * s)});
    pose.translation() << 0.04 * kSpeed / 0.5 * (1.0 - std::cos(0.5 * s)), kSpeed * s,
        kEyes + 0.01 * std::sin(11.0 * s);
    return pose;
  }
  [[nodiscard]] Instant instant(int index, double aside) const {
    Instant now;
    now.world_from_camera = world_from_camera(index);
    now.world_from_camera.translate(Eigen::Vector3d(aside, 0, 0));
    Primitive car = car_;
    car.centre += Vector3f(-2.6F, static_cast<float>(55.0 - 8.0 * index / kRate), 0.0F);
    now.actors.push_back(car);
    return now;
  }
  [[nodiscard]] Rendering seen(int index, double aside) const {
    const Instant now = instant(index, aside);
    const std::array<Instant, 4> samples = {now, now, now, now};
    return cast_frame(scene_, camera(), now, samples, 1.0);
  }

  std::string name_ = "street";
  Scene scene_;
  StereoMatcher matcher_;
  int frames_;
  Sensor left_sensor_, right_sensor_;
  Primitive car_;
  Trajectory ground_truth_;
  std::vector<std::string> warnings_;
};

}  // namespace

std::unique_ptr<FrameSource> make_street(int frames, double scale, const StereoOptions& stereo) {
  return std::make_unique<Street>(frames, scale, stereo);
}

}  // namespace stillpoint::testing
