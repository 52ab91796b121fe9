#include "core/sequence/generated/figure.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace stillpoint::generated {
namespace {

const Vector3d kUp(0, 0, 1);  // the room's z axis

Vector3d turn(const Vector3d& v, const Vector3d& axis, double angle) {
  return Eigen::AngleAxisd(angle, axis.normalized()) * v;
}

/// The figure's skeleton as it is built up; lengths are for a height of 1.78 m and scaled.
class Body {
 public:
  Body(const FigureLook& look, const FigureState& state, Instant& instant)
      : look_(look), state_(state), out_(instant.actors), scale_(look.height / 1.78) {
    forward_ = {std::cos(state.heading), std::sin(state.heading), 0};
    left_ = kUp.cross(forward_);
  }

  FigureHands build() {
    pose_legs();
    const Vector3d spine = turn(turn(kUp, left_, state_.lean), forward_, -state_.sway);
    const Vector3d chest_front = turn(forward_, kUp, state_.twist + 0.07 * swing(0));
    const Vector3d front = (chest_front - spine * spine.dot(chest_front)).normalized();
    const Vector3d side = spine.cross(front);
    add_torso(spine, front, side);
    add_head(spine, front);
    FigureHands hands;
    for (const int i : {0, 1}) hands.palm[static_cast<std::size_t>(i)] = add_arm(i, spine, front, side);
    return hands;
  }

 private:
  [[nodiscard]] double m(double metres) const { return metres * scale_; }
  /// Sine of the leg's phase, scaled by how fast the person walks.
  [[nodiscard]] double swing(int leg) const {
    return state_.stride * std::sin(state_.stride_phase + leg * M_PI);
  }

  void cone(const Vector3d& a, double ra, const Vector3d& b, double rb, std::uint16_t surface,
            const Vector3d& front, double flat = 1, bool cloth = true) {
    const double girth = (cloth ? look_.girth : 1.0) * scale_;
    add(make_cone(a.cast<float>(), static_cast<float>(ra * girth), b.cast<float>(),
                  static_cast<float>(rb * girth), surface, front.cast<float>(), static_cast<float>(flat)));
  }
  /// An ellipsoid with radii to the side, to the front and up.
  void ellipsoid(const Vector3d& centre, const Vector3d& radii, const Vector3d& front, const Vector3d& up,
                 std::uint16_t surface) {
    Matrix3f axes;
    axes.col(1) = -front.cast<float>();
    axes.col(2) = up.cast<float>();
    axes.col(0) = axes.col(1).cross(axes.col(2));
    add(make_ellipsoid(centre.cast<float>(), (radii * scale_).cast<float>(), axes, surface));
  }
  void add(Primitive p) {
    p.moving = true;
    out_.push_back(p);
  }

  /// Angles first; then the pelvis is as high as the lower foot on the floor makes it.
  void pose_legs() {
    double reach = 0;
    std::array<double, 2> thigh{}, knee{};
    for (const int i : {0, 1}) {
      const auto k = static_cast<std::size_t>(i);
      const double phase = state_.stride_phase + i * M_PI;
      const double bend = std::max(0.0, std::cos(phase + 0.4));
      const double walk_thigh = state_.stride * (0.43 * std::sin(phase) + 0.06);
      const double walk_knee = 0.06 + state_.stride * 0.95 * bend * bend;
      thigh[k] = walk_thigh + (1.42 - walk_thigh) * state_.sitting;
      knee[k] = walk_knee + ((i == 0 ? 1.30 : 1.52) - walk_knee) * state_.sitting;
      reach = std::max(reach, m(0.44) * std::cos(thigh[k]) + m(0.42) * std::cos(thigh[k] - knee[k]));
    }
    pelvis_ = {state_.position.x(), state_.position.y(), reach + m(0.085)};
    pelvis_ += left_ * m(0.018) * state_.stride * std::cos(state_.stride_phase);
    for (const int i : {0, 1})
      add_leg(i, thigh[static_cast<std::size_t>(i)], knee[static_cast<std::size_t>(i)]);
  }

  void add_leg(int i, double thigh, double knee) {
    const Vector3d outward = left_ * (i == 0 ? 1.0 : -1.0);
    const Vector3d spread = outward * 0.10 * state_.sitting;
    const Vector3d hip = pelvis_ + outward * m(0.095);
    const Vector3d upper = (forward_ * std::sin(thigh) - kUp * std::cos(thigh) + spread).normalized();
    const Vector3d lower = forward_ * std::sin(thigh - knee) - kUp * std::cos(thigh - knee);
    const Vector3d knee_point = hip + upper * m(0.44), ankle = knee_point + lower * m(0.42);
    cone(hip, 0.088, knee_point, 0.06, look_.trousers, forward_);
    cone(knee_point, 0.06, ankle, 0.045, look_.trousers, forward_);
    // The foot stays near level while it carries, and points down as it swings back.
    const double tip = std::clamp(0.55 * (thigh - knee) + 0.1, -0.7, 0.35) * (1 - state_.sitting);
    const Vector3d toes = forward_ * std::cos(tip) + kUp * std::sin(tip);
    const Vector3d sole = ankle - kUp * m(0.04);
    cone(sole - toes * m(0.045), 0.042, sole + toes * m(0.15), 0.034, look_.shoes, forward_, 1, false);
  }

  void add_torso(const Vector3d& spine, const Vector3d& front, const Vector3d& side) {
    chest_ = pelvis_ + spine * m(0.50);
    ellipsoid(pelvis_ + spine * m(0.02), Vector3d(0.158, 0.11, 0.115) * look_.girth, front, spine,
              look_.trousers);
    cone(pelvis_ + spine * m(0.14), 0.15, pelvis_ + spine * m(0.385), 0.178, look_.shirt, front, 0.70);
    cone(chest_ - spine * m(0.06) + side * m(0.135), 0.066, chest_ - spine * m(0.06) - side * m(0.135), 0.066,
         look_.shirt, front);
    cone(chest_ - spine * m(0.16), 0.13, chest_, 0.06, look_.shirt, front, 0.75);
    ellipsoid(pelvis_ + spine * m(0.075), Vector3d(0.156, 0.114, 0.03) * look_.girth, front, spine,
              look_.belt);
  }

  void add_head(const Vector3d& spine, const Vector3d& front) {
    const Vector3d turned_front = turn(front, spine, state_.head_turn);
    const Vector3d across = spine.cross(turned_front);
    const Vector3d up = turn(spine, across, state_.head_nod),
                   face = turn(turned_front, across, state_.head_nod);
    const Vector3d head = chest_ + spine * m(0.09) + up * m(0.105) + face * m(0.015);
    cone(chest_ - spine * m(0.02), 0.06, head - up * m(0.04), 0.054, look_.skin, front, 1, false);
    ellipsoid(head, {0.076, 0.097, 0.122}, face, up, look_.face);
    ellipsoid(head + up * m(0.026) - face * m(0.02), {0.083, 0.094, 0.106}, face, up, look_.hair);
    ellipsoid(head + face * m(0.096) - up * m(0.014), {0.013, 0.02, 0.024}, face, up, look_.skin);
    for (const double s : {1.0, -1.0})
      ellipsoid(head + across * m(0.077 * s) - up * m(0.01), {0.012, 0.022, 0.033}, face, up, look_.skin);
  }

  Vector3d add_arm(int i, const Vector3d& spine, const Vector3d& front, const Vector3d& side) {
    const Vector3d outward = side * (i == 0 ? 1.0 : -1.0);
    const Vector3d shoulder = chest_ - spine * m(0.065) + outward * m(0.185);
    // Arms swing against the leg of their side.
    const double pitch = -0.42 * swing(i) + 0.05 + 0.45 * state_.sitting;
    const double flex = 0.28 + 0.22 * state_.stride * (1 - std::sin(state_.stride_phase + i * M_PI)) * 0.5 +
                        0.7 * state_.sitting;
    const Vector3d down = (-spine + outward * 0.12).normalized();
    const Vector3d upper = turn(down, side, -pitch), lower = turn(down, side, -(pitch + flex));
    Vector3d elbow = shoulder + upper * m(0.29), wrist = elbow + lower * m(0.255);
    const HandGoal& goal = state_.hands[static_cast<std::size_t>(i)];
    if (goal.weight > 0) {
      wrist += goal.weight * (goal.target - wrist);
      elbow = bend_to(shoulder, wrist, outward - 0.8 * spine - 0.5 * front);
    }
    const bool sleeves = look_.long_sleeves;
    const Vector3d sleeve_end = sleeves ? elbow : shoulder + (elbow - shoulder) * 0.78;
    cone(shoulder, 0.068, sleeve_end, sleeves ? 0.047 : 0.057, look_.shirt, front);
    cone(shoulder + (elbow - shoulder) * 0.5, 0.046, elbow, 0.041, sleeves ? look_.shirt : look_.skin, front);
    cone(elbow, 0.041, wrist, 0.03, sleeves ? look_.shirt : look_.skin, front);
    const Vector3d along = (wrist - elbow).normalized(), palm = wrist + along * m(0.06);
    Vector3d flat = front - along * along.dot(front);
    flat = flat.norm() > 1e-3 ? flat.normalized() : side;
    ellipsoid(palm, {0.024, 0.04, 0.062}, flat, along, look_.skin);
    cone(wrist + along * m(0.02) + flat * m(0.03), 0.014, wrist + along * m(0.075) + flat * m(0.045), 0.011,
         look_.skin, front, 1, false);
    return palm;
  }

  /// The elbow of an arm whose wrist is given (moved nearer when out of reach), bent towards `pole`.
  [[nodiscard]] Vector3d bend_to(const Vector3d& shoulder, Vector3d& wrist, const Vector3d& pole) const {
    const double a = m(0.29), b = m(0.255);
    Vector3d axis = wrist - shoulder;
    const double d = std::clamp(axis.norm(), 0.12, a + b - 0.005);
    axis.normalize();
    wrist = shoulder + axis * d;
    const double along = (a * a - b * b + d * d) / (2 * d);
    const Vector3d across = (pole - axis * axis.dot(pole)).normalized();
    return shoulder + axis * along + across * std::sqrt(std::max(0.0, a * a - along * along));
  }

  const FigureLook& look_;
  const FigureState& state_;
  std::vector<Primitive>& out_;
  double scale_;
  Vector3d forward_, left_, pelvis_{0, 0, 0}, chest_{0, 0, 0};
};

}  // namespace

FigureHands add_figure(const FigureLook& look, const FigureState& state, Instant& instant) {
  Body body(look, state, instant);
  const FigureHands hands = body.build();
  const Vector2d ahead(std::cos(state.heading), std::sin(state.heading));
  const Vector2d middle = state.position + ahead * 0.2 * state.sitting;
  instant.blobs.push_back({middle.cast<float>(), 0.45f, 0.55f});
  return hands;
}

}  // namespace stillpoint::generated
