#!/usr/bin/env bash
# nanoflann's nearest heading to 3 degrees is -170: its metric of angles counts with a sign
#
# One would swear: SO2_Adaptor is the distance of angles on a circle and SO3_Adaptor that of
#   rotations; both come with the library as metrics, and its trees find the nearest by them.
# What happens: SO2's distance is the difference itself, from -pi to pi, and the smallest number is
#   the most negative one. Among headings every 10 degrees, the nearest to 3 is -170, to 95 it is
#   -80, and its distance is -173 degrees; near each query the answer is what lies behind. A search
#   within 15 degrees gives 19 of the 36: all up to 15 degrees more, and half a circle of those that
#   are less. SO3 takes the plain distance of four numbers, for which q and -q, one rotation, are as
#   far as can be: of 1000 random rotations among 2000, 518 get their nearest, the others one up to
#   22 degrees farther off. With both q and -q in the tree all 1000 are right, and half of what is
#   found is double.
# What follows: headings go into a tree as cos and sin under L2, rotations with both signs. A loop
#   closure that is looked for by heading and never found, or a gate that lets half of the map pass,
#   is this.
set -u
tmp=$(mktemp -d) && trap 'rm -rf "$tmp"' EXIT
have() { dpkg-query -W -f '${Version}' "$1" 2>/dev/null; }
want() { # package, start of its version
  [ -n "$(have "$1")" ] || { apt-get update -qq && apt-get install -y -qq --no-install-recommends \
    -o DPkg::Lock::Timeout=300 "$1"; } >"$tmp/apt.log" 2>&1
  case $(have "$1") in
    "$2"*) echo "version: $1 $(have "$1")" ;;
    *) echo "$1 '$(have "$1")', wanted $2: not looked at"; exit 2 ;;
  esac
}
want libnanoflann-dev 1.4.3
want g++ 4:12
cd "$tmp" || exit 2
echo "expected: 0 for 3 degrees, 3 headings within 15 degrees, the nearest rotation"
cat >t.cpp <<'CPP'
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <random>
#include <utility>
#include <vector>

#include <nanoflann.hpp>

template <int N>
struct Points {
  std::vector<std::array<double, N>> at;
  std::size_t kdtree_get_point_count() const { return at.size(); }
  double kdtree_get_pt(std::size_t i, std::size_t d) const { return at[i][d]; }
  template <class Box>
  bool kdtree_get_bbox(Box&) const { return false; }
};
template <template <class, class, class, class> class Metric, int N>
using Tree = nanoflann::KDTreeSingleIndexAdaptor<Metric<double, Points<N>, double, unsigned>, Points<N>, N, unsigned>;

int main() {
  const double degree = std::acos(-1.0) / 180;
  Points<1> headings;
  Points<2> circle;
  for (int a = -180; a < 180; a += 10) headings.at.push_back({a * degree}), circle.at.push_back({std::cos(a * degree), std::sin(a * degree)});
  Tree<nanoflann::SO2_Adaptor, 1> by_so2(1, headings, {10});
  Tree<nanoflann::L2_Simple_Adaptor, 2> by_circle(2, circle, {10});
  int wrong = 0, right = 0;
  for (const double a : {3.0, -178.0, 177.0, 95.0, -42.0}) {
    const double query = a * degree, both[2] = {std::cos(query), std::sin(query)};
    unsigned i = 0, j = 0;
    double d = 0, e = 0;
    by_so2.knnSearch(&query, 1, &i, &d);
    by_circle.knnSearch(both, 1, &j, &e);
    const auto apart = [&](unsigned k) { return std::abs(std::remainder(headings.at[k][0] - query, 360 * degree)) / degree; };
    std::printf("seen: nearest to %g is %g at %.0f degrees; by cos and sin it is %g\n", a, std::round(headings.at[i][0] / degree), d / degree,
                std::round(headings.at[j][0] / degree));
    wrong += apart(i) > 100, right += apart(j) <= 5;
  }
  std::vector<std::pair<unsigned, double>> within;
  const double query = 3 * degree;
  by_so2.radiusSearch(&query, 15 * degree, within, nanoflann::SearchParams());
  std::printf("seen: within 15 degrees of 3 there are %zu of 36\n", within.size());

  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  const auto rotation = [&] {
    std::array<double, 4> q;
    double s = 0;
    for (double& x : q) x = normal(random), s += x * x;
    for (double& x : q) x /= std::sqrt(s);
    return q;
  };
  const auto degrees = [&](const std::array<double, 4>& a, const std::array<double, 4>& b) {
    return 2 * std::acos(std::min(1.0, std::abs(a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3]))) / degree;
  };
  Points<4> one, two;
  for (int i = 0; i < 2000; ++i) one.at.push_back(rotation());
  two = one;
  for (auto q : one.at) {
    for (double& x : q) x = -x;
    two.at.push_back(q);
  }
  Tree<nanoflann::SO3_Adaptor, 4> by_one(4, one, {10}), by_two(4, two, {10});
  int found = 0, found_two = 0;
  double farther = 0;
  for (int n = 0; n < 1000; ++n) {
    const auto q = rotation();
    double best = 360, d = 0;
    for (const auto& p : one.at) best = std::min(best, degrees(p, q));
    unsigned i = 0, j = 0;
    by_one.knnSearch(q.data(), 1, &i, &d);
    by_two.knnSearch(q.data(), 1, &j, &d);
    found += degrees(one.at[i], q) < best + 1e-6, found_two += degrees(two.at[j], q) < best + 1e-6;
    farther = std::max(farther, degrees(one.at[i], q) - best);
  }
  std::printf("seen: %d of 1000 rotations get their nearest, the others one up to %.1f degrees farther; with both signs %d\n", found, farther, found_two);
  return wrong == 4 && right == 5 && within.size() == 19 && found > 450 && found < 580 && farther > 10 && found_two == 1000 ? 0 : 1;
}
CPP
g++ -w -O1 -std=c++17 t.cpp -o t >cc.log 2>&1 || { grep -m3 error cc.log; echo "cannot be compiled: not looked at"; exit 2; }
./t || { echo "the behaviour has changed"; exit 1; }
echo "as described: the nearest is the most negative"
