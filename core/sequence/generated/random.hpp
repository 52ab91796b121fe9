#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "core/sequence/generated/lanes.hpp"

namespace stillpoint::generated {

// Randomness by counting: every value is a function of what it is for (pixel, frame, seed), so it never
// depends on the order in which, or the thread on which, values are drawn.

/// Mixes four counters into 32 well-spread bits.
[[nodiscard]] inline std::uint32_t hash(std::uint32_t a, std::uint32_t b = 0, std::uint32_t c = 0,
                                        std::uint32_t d = 0) {
  std::uint32_t h = a * 0x9E3779B1u ^ (b + 0x7F4A7C15u) * 0x85EBCA77u ^ (c + 0x165667B1u) * 0xC2B2AE3Du ^
                    (d + 0x27D4EB2Fu) * 0x27D4EB2Fu;
  h ^= h >> 15;
  h *= 0x2C1B3C6Du;
  h ^= h >> 12;
  h *= 0x297A2D39u;
  return h ^ h >> 15;
}

/// The same, a lane each.
template <int N>
STILLPOINT_PACKET Bits<N> hash(const Bits<N>& a, const Bits<N>& b, const Bits<N>& c = Bits<N>{},
                               const Bits<N>& d = Bits<N>{}) {
  Bits<N> h = a * 0x9E3779B1u ^ (b + 0x7F4A7C15u) * 0x85EBCA77u ^ (c + 0x165667B1u) * 0xC2B2AE3Du ^
              (d + 0x27D4EB2Fu) * 0x27D4EB2Fu;
  h ^= h >> 15;
  h *= 0x2C1B3C6Du;
  h ^= h >> 12;
  h *= 0x297A2D39u;
  return h ^ h >> 15;
}

/// 0 to 1.
[[nodiscard]] inline float uniform(std::uint32_t bits) {
  return static_cast<float>(bits >> 8) * (1.0f / 16777216.0f);
}

/// Mean 0, deviation 1, within ±3.5: the sum of the four bytes, near enough to normal for sensor noise.
[[nodiscard]] inline float gaussian(std::uint32_t bits) {
  const std::uint32_t sum = (bits & 255u) + (bits >> 8 & 255u) + (bits >> 16 & 255u) + (bits >> 24);
  return (static_cast<float>(sum) - 510.0f) * (1.0f / 147.8f);
}

template <int N>
STILLPOINT_PACKET Floats<N> gaussian(const Bits<N>& bits) {
  const Bits<N> sum = (bits & 255u) + (bits >> 8 & 255u) + (bits >> 16 & 255u) + (bits >> 24);
  return (to_floats<N>(reinterpret_cast<Ints<N>>(sum)) - 510.0f) * (1.0f / 147.8f);
}

/// A stream of numbers for building scenes, where order is fixed.
class Dice {
 public:
  explicit Dice(std::uint32_t seed) : seed_(seed) {}
  [[nodiscard]] std::uint32_t bits() { return hash(seed_, count_++, 77u); }
  /// Between `low` and `high`.
  [[nodiscard]] double between(double low, double high) {
    return low + (high - low) * static_cast<double>(uniform(bits()));
  }
  /// From 0 to `count` - 1.
  [[nodiscard]] int below(int count) {
    return static_cast<int>(bits() % static_cast<std::uint32_t>(count > 0 ? count : 1));
  }

 private:
  std::uint32_t seed_, count_ = 0;
};

/// A smooth function of time made of sinusoids: what hands, heads and exposure controllers do.
class Wander {
 public:
  Wander() = default;
  /// `waves` sinusoids with frequencies spread over [low, high] Hz, together of about the given amplitude.
  Wander(Dice& dice, double amplitude, double low, double high, int waves) {
    for (int i = 0; i < waves; ++i) {
      const double share = waves > 1 ? (i + dice.between(0.1, 0.9)) / waves : 0.5;
      waves_.push_back({amplitude / std::sqrt(static_cast<double>(waves)) * dice.between(0.7, 1.3),
                        6.283185307179586 * (low + (high - low) * share),
                        dice.between(0.0, 6.283185307179586)});
    }
  }
  [[nodiscard]] double at(double seconds) const {
    double sum = 0;
    for (const Wave& w : waves_) sum += w.amplitude * std::sin(w.rate * seconds + w.phase);
    return sum;
  }

 private:
  struct Wave {
    double amplitude, rate, phase;
  };
  std::vector<Wave> waves_;
};

}  // namespace stillpoint::generated
