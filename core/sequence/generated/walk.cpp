#include "core/sequence/generated/walk.hpp"

#include <algorithm>
#include <cmath>

namespace stillpoint::generated {
namespace {

constexpr double kPairOfSteps = 1.38;  // m, at full stride
constexpr double kFullSpeed = 1.15;    // m/s at which steps are longest
constexpr double kTurnRate = 2.6;      // rad/s: a quarter turn takes a walker over half a second
constexpr double kStroll = 0.75;       // people in a room are in no hurry
constexpr double kElbowRoom = 0.75;    // m people keep from each other

double wrapped(double angle) { return std::remainder(angle, 2 * M_PI); }

struct Person {
  const std::vector<Stop>* route;
  std::size_t next = 0;
  Vector2d position, velocity{0, 0};
  double heading = 0, phase = 0, sitting = 0, waited = 0;
  bool waiting = false;

  void step(double dt, const std::vector<Person>& others) {
    const Stop& stop = (*route)[next];
    Vector2d wanted(0, 0);
    double wanted_heading = heading;
    double wanted_sitting = 0;
    if (waiting) {
      waited += dt;
      wanted_heading = stop.heading;
      wanted = (stop.position - position) * 2;
      wanted_sitting = stop.sits && waited > 0.6 && waited < stop.pause - 1.6 ? 1 : 0;
      if (waited >= stop.pause) waiting = false, waited = 0, next = (next + 1) % route->size();
    } else {
      const Vector2d way = stop.position - position;
      const double distance = way.norm();
      const double bearing = std::atan2(way.y(), way.x()), off = std::abs(wrapped(bearing - heading));
      const double slow = stop.pause > 0 ? std::clamp(distance / 0.6, 0.25, 1.0) : 1.0;
      wanted_heading = bearing;
      const double speed = kStroll * stop.speed * slow * std::max(0.1, std::cos(std::min(off, M_PI / 2)));
      wanted = speed * Vector2d(std::cos(heading), std::sin(heading));
      if (distance < (stop.pause > 0 ? 0.08 : 0.35)) {
        waiting = stop.pause > 0;
        if (!waiting) next = (next + 1) % route->size();
      }
    }
    if (sitting < 0.05 && !waiting)
      for (const Person& other : others) {
        const Vector2d apart = position - other.position;
        const double gap = apart.norm();
        if (gap > 1e-6 && gap < kElbowRoom) wanted += apart / gap * (kElbowRoom - gap) * 3;
      }
    if (sitting > 0.15) wanted *= 0;
    velocity += (wanted - velocity) * std::min(1.0, 7 * dt);
    position += velocity * dt;
    heading += std::clamp(wrapped(wanted_heading - heading) * 5, -kTurnRate, kTurnRate) * (1 - sitting) * dt;
    sitting += std::clamp(wanted_sitting - sitting, -dt / 1.1, dt / 1.1);
    phase += 2 * M_PI * velocity.norm() / (kPairOfSteps * std::max(0.45, stride())) * dt;
  }
  [[nodiscard]] double stride() const { return std::min(1.1, std::sqrt(velocity.norm() / kFullSpeed)); }
};

}  // namespace

Walk::Walk(const std::vector<std::vector<Stop>>& routes, double seconds) {
  std::vector<Person> people;
  for (const auto& route : routes) {
    Person person;
    person.route = &route;
    person.position = route.back().position;
    const Vector2d way = route.front().position - person.position;
    person.heading = std::atan2(way.y(), way.x());
    people.push_back(person);
  }
  const int count = static_cast<int>(seconds * kRate) + 2;
  samples_.resize(people.size());
  for (int i = 0; i < count; ++i) {
    for (std::size_t k = 0; k < people.size(); ++k) {
      const Person& p = people[k];
      const double soft = p.sitting * p.sitting * (3 - 2 * p.sitting);
      samples_[k].push_back({p.position, p.heading, p.phase, p.stride(), soft});
    }
    for (std::size_t k = 0; k < people.size(); ++k) {
      std::vector<Person> others;
      for (std::size_t o = 0; o < people.size(); ++o)
        if (o != k) others.push_back(people[o]);
      people[k].step(1 / kRate, others);
    }
  }
}

FigureState Walk::at(std::size_t person, double seconds) const {
  const auto& samples = samples_[person];
  const double place = std::clamp(seconds * kRate, 0.0, static_cast<double>(samples.size()) - 1.001);
  const auto i = static_cast<std::size_t>(place);
  const double a = place - static_cast<double>(i);
  const Sample &p = samples[i], &q = samples[i + 1];
  FigureState state;
  state.position = p.position + a * (q.position - p.position);
  state.heading = p.heading + a * (q.heading - p.heading);
  state.stride_phase = p.phase + a * (q.phase - p.phase);
  state.stride = p.stride + a * (q.stride - p.stride);
  state.sitting = p.sitting + a * (q.sitting - p.sitting);
  return state;
}

}  // namespace stillpoint::generated
