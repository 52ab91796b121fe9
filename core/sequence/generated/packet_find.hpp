#pragma once

#include <algorithm>
#include <array>
#include <cstring>
#include <opencv2/core.hpp>
#include <span>

#include "core/sequence/generated/packet_meet.hpp"
#include "core/sequence/generated/view.hpp"

namespace stillpoint::generated {

/// Where a packet lies in the image: its first pixel. Packets do not cross tiles.
struct PacketPlace {
  int x, y;
};

/// Rays through a place in each pixel of a packet.
template <int N>
STILLPOINT_PACKET Vectors<N> rays(const View& view, const PacketPlace& place, float offset_x,
                                  float offset_y) {
  const Floats<N> x = counted_from<N>(static_cast<float>(place.x)) + offset_x;
  const float y = static_cast<float>(place.y) + offset_y;
  return {(x - view.cx) * view.inverse_fx, broadcast<N>((y - view.cy) * view.inverse_fy), broadcast<N>(1.0f)};
}

/// The first of the candidates, nearest first, that each of the rays `who` meets.
/// @param culled whether candidates that cannot show in the packet's pixels are passed over: where the view
/// is the one that the candidates' bounds are of
template <int N>
STILLPOINT_PACKET Hits<N> nearest(const View& view, std::span<const Candidate> candidates,
                                  const PacketPlace& place, const Vectors<N>& ray, const Ints<N>& who,
                                  bool culled) {
  Hits<N> hits;
  const auto first = static_cast<float>(place.x), last = first + N - 1, y = static_cast<float>(place.y);
  for (const Candidate& c : candidates) {
    const Ints<N> allowed = who & (c.bounds.nearest <= hits.depth);
    if (!any<N>(allowed)) break;
    if (!culled || c.bounds.reach(first, last, y))
      meet<N>({c.id, allowed, Ints<N>{}}, view.seen[c.id], ray, hits);
  }
  return hits;
}

/// What was seen beside each of a packet's pixels; beyond the image's edges, at them.
template <int N>
STILLPOINT_PACKET Shorts<N> ids_beside(const cv::Mat& id, const PacketPlace& place, int right, int down) {
  const auto* row = id.ptr<std::uint16_t>(std::clamp(place.y + down, 0, id.rows - 1));
  const int first = place.x + right;
  Shorts<N> found;
  if (first >= 0 && first + N <= id.cols) {
    std::memcpy(&found, row + first, sizeof found);
    return found;
  }
  for (int i = 0; i < N; ++i) found[i] = row[std::clamp(first + i, 0, id.cols - 1)];
  return found;
}

/// The few primitives that the samples of a packet's pixels can meet: those seen about each at mid exposure.
template <int N>
struct Nearby {
  static constexpr int kMost = 12;  // primitives a pixel: what is met after so many is left out
  static constexpr std::int32_t kAbsent = 1 << 20;  // a rank beyond all ids, which are of 16 bits
  int count = 0;
  std::array<std::int32_t, kMost * N> ids;
  std::array<Ints<N>, kMost * N> ranks;  ///< in which order a pixel looks at them; kAbsent: it does not
};

/// Candidates of each pixel of a packet, first come first.
template <int N>
struct PixelLists {
  static constexpr std::uint16_t kNone = 0xFFFF;  // an id beyond those that scenes have
  std::array<Shorts<N>, Nearby<N>::kMost> ids;    ///< kNone past a pixel's last
  Shorts<N> counts{};
  int longest = 0;
};

template <int N>
STILLPOINT_PACKET void append(const Shorts<N>& id, PixelLists<N>& lists) {
  auto known = lists.counts == Nearby<N>::kMost;
  for (int j = 0; j < lists.longest; ++j) known |= lists.ids[static_cast<std::size_t>(j)] == id;
  if (!any_bits(~known)) return;
  for (int i = 0; i < N; ++i) {
    if (known[i] != 0) continue;
    const int j = lists.counts[i];
    if (j == lists.longest)
      lists.ids[static_cast<std::size_t>(lists.longest++)] = Shorts<N>{} + PixelLists<N>::kNone;
    lists.ids[static_cast<std::size_t>(j)][i] = id[i];
    lists.counts[i] = static_cast<std::uint16_t>(j + 1);
  }
}

/// One list of all pixels' candidates.
template <int N>
STILLPOINT_PACKET void join(const PixelLists<N>& lists, Nearby<N>& nearby) {
  for (int j = 0; j < lists.longest; ++j)
    for (int i = 0; i < N; ++i) {
      const std::int32_t id = lists.ids[static_cast<std::size_t>(j)][i];
      if (id == PixelLists<N>::kNone) continue;
      std::size_t k = 0;
      while (k < static_cast<std::size_t>(nearby.count) && nearby.ids[k] != id) ++k;
      if (k == static_cast<std::size_t>(nearby.count)) {
        nearby.ids[k] = id;
        nearby.ranks[k] = broadcast<N>(Nearby<N>::kAbsent);
        ++nearby.count;
      }
      nearby.ranks[k][i] = j;
    }
}

/// @param id CV_16UC1, at mid exposure @param reach how far to look, px
template <int N>
STILLPOINT_PACKET void look_about(const cv::Mat& id, const PacketPlace& place, int reach, Nearby<N>& nearby) {
  PixelLists<N> lists;
  append<N>(ids_beside<N>(id, place, 0, 0), lists);
  for (const int r : {1, (reach + 1) / 2, reach}) {
    for (const int down : {-r, 0, r})
      for (const int right : {-r, 0, r})
        if (right != 0 || down != 0) append<N>(ids_beside<N>(id, place, right, down), lists);
    if (r == reach) break;
  }
  join<N>(lists, nearby);
}

/// What rays meet first of what is nearby.
template <int N>
STILLPOINT_PACKET Hits<N> nearest(const View& view, const Nearby<N>& nearby, const Vectors<N>& ray) {
  Hits<N> hits;
  for (int k = 0; k < nearby.count; ++k) {
    const std::int32_t id = nearby.ids[static_cast<std::size_t>(k)];
    const Ints<N>& rank = nearby.ranks[static_cast<std::size_t>(k)];
    meet<N>({id, rank != Nearby<N>::kAbsent, rank}, view.seen[static_cast<std::size_t>(id)], ray, hits);
  }
  return hits;
}

}  // namespace stillpoint::generated
