#pragma once

#include <cstdint>
#include <cstring>

// Numbers beside each other, reckoned with together: vectors that compilers know, as wide as a caller's
// processor has them. Every lane is reckoned in single precision in the order in which one number alone would
// be, so that neither the number of lanes nor the processor shows in a result.
//
// All of it is compiled into its caller, for whose processor it is meant.
#define STILLPOINT_PACKET [[gnu::always_inline]] inline

namespace stillpoint::generated {

template <int N>
struct Lanes {
  typedef float Floats __attribute__((vector_size(N * sizeof(float))));
  typedef std::int32_t Ints __attribute__((vector_size(N * sizeof(std::int32_t))));  ///< masks: -1 or 0
  typedef std::uint16_t Shorts __attribute__((vector_size(N * sizeof(std::uint16_t))));
  typedef std::uint32_t Bits __attribute__((vector_size(N * sizeof(std::uint32_t))));
};
template <int N>
struct PairLanes {
  typedef std::uint64_t Pairs __attribute__((vector_size(N * sizeof(std::uint32_t))));
};
template <int N>
using Floats = typename Lanes<N>::Floats;
template <int N>
using Ints = typename Lanes<N>::Ints;
template <int N>
using Bits = typename Lanes<N>::Bits;
template <int N>
using Shorts = typename Lanes<N>::Shorts;
/// Half as many lanes of two numbers each.
template <int N>
using Pairs = typename PairLanes<N>::Pairs;

/// How many lanes this processor has, 4 or 8.
[[nodiscard]] inline int most_lanes() {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx2")) return 8;
#endif
  return 4;
}

template <int N>
STILLPOINT_PACKET Floats<N> broadcast(float value) {
  return value - Floats<N>{};
}
template <int N>
STILLPOINT_PACKET Ints<N> broadcast(std::int32_t value) {
  return value - Ints<N>{};
}
template <int N>
STILLPOINT_PACKET Bits<N> broadcast(std::uint32_t value) {
  return value - Bits<N>{};
}
template <int N>
STILLPOINT_PACKET Floats<N> counted_from(float first) {
  Floats<N> lanes;
  for (int i = 0; i < N; ++i) lanes[i] = first + static_cast<float>(i);
  return lanes;
}

template <int N>
STILLPOINT_PACKET Bits<N> counted_from(std::uint32_t first) {
  Bits<N> lanes;
  for (int i = 0; i < N; ++i) lanes[i] = first + static_cast<std::uint32_t>(i);
  return lanes;
}

/// Parts pairs into their first and second numbers.
template <int N>
STILLPOINT_PACKET void part(const Pairs<N>& a, const Pairs<N>& b, Ints<N>& first, Ints<N>& second) {
  const Ints<N> low = reinterpret_cast<Ints<N>>(a), high = reinterpret_cast<Ints<N>>(b);
  if constexpr (N == 8) {
    first = __builtin_shufflevector(low, high, 0, 2, 4, 6, 8, 10, 12, 14);
    second = __builtin_shufflevector(low, high, 1, 3, 5, 7, 9, 11, 13, 15);
  } else {
    static_assert(N == 4);
    first = __builtin_shufflevector(low, high, 0, 2, 4, 6);
    second = __builtin_shufflevector(low, high, 1, 3, 5, 7);
  }
}

/// Whether a mask of any width holds anything.
template <typename Mask>
STILLPOINT_PACKET bool any_bits(const Mask& mask) {
  if constexpr (sizeof(Mask) > 16) {
    Ints<4> halves[2];
    std::memcpy(halves, &mask, sizeof halves);
    return any_bits(halves[0] | halves[1]);
  } else {
    std::uint64_t words[sizeof(Mask) / 8], bits = 0;
    std::memcpy(words, &mask, sizeof words);
    for (const std::uint64_t word : words) bits |= word;
    return bits != 0;
  }
}
template <int N>
STILLPOINT_PACKET bool any(const Ints<N>& mask) {
  return any_bits(mask);
}

template <int N>
STILLPOINT_PACKET Floats<N> absolute(const Floats<N>& x) {
  return reinterpret_cast<Floats<N>>(reinterpret_cast<Ints<N>>(x) & 0x7FFFFFFF);
}
template <int N>
STILLPOINT_PACKET Floats<N> square_root(const Floats<N>& x) {
  Floats<N> root;
  for (int i = 0; i < N; ++i) root[i] = __builtin_sqrtf(x[i]);
  return root;
}
template <int N>
STILLPOINT_PACKET Floats<N> lesser(const Floats<N>& a, const Floats<N>& b) {
  return b < a ? b : a;
}
template <int N>
STILLPOINT_PACKET Floats<N> greater(const Floats<N>& a, const Floats<N>& b) {
  return a < b ? b : a;
}
template <int N>
STILLPOINT_PACKET Floats<N> to_floats(const Ints<N>& x) {
  return __builtin_convertvector(x, Floats<N>);
}
template <int N>
STILLPOINT_PACKET Ints<N> truncated(const Floats<N>& x) {
  return __builtin_convertvector(x, Ints<N>);
}
template <int N>
STILLPOINT_PACKET Ints<N> floor_of(const Floats<N>& x) {
  const Ints<N> whole = truncated<N>(x);
  return whole + (x < to_floats<N>(whole));  // a true comparison is -1
}

}  // namespace stillpoint::generated
