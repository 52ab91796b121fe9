#!/usr/bin/env bash
# Eigen reads s * (M * v) as (s * M) * v, brackets or not
#
# One would swear: brackets say what is computed first: of 2 * (M * v) the product,
#   three numbers, and then three multiplications by the scalar; the same bits as
#   naming the product p = M * v and writing 2 * p.
# What happens: the product is no value yet but an expression, and an assignment of
#   a scaled product takes the scalar into its left factor, so that every element of M is
#   multiplied. Of random 3x3 products in single precision, some 93 in 100 differ in
#   their last bits from s * p; all of them are those of (s * M) * v. No option of
#   the compiler is at work: it is so without optimisation as well.
# What follows: code that must give the same bits as other code (another language, a
#   vectorised copy, a test's expectation) is to name the product first, or to ask for
#   (M * v).eval(). It costs less, too: three multiplications for nine, and of
#   larger matrices a copy.
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
want libeigen3-dev 3.4.0
want g++ 4:12
echo "expected: all of s * (M * v) equal to s * p, where p = M * v"
cat >"$tmp/t.cpp" <<'CPP'
#include <Eigen/Dense>
#include <cstdio>
#include <random>

int main() {
  std::mt19937 generator(1);
  std::uniform_real_distribution<float> number(-1, 1);
  const auto draw = [&](auto& of) {
    for (int k = 0; k < of.size(); ++k) of.data()[k] = number(generator);
  };
  constexpr int kTrials = 10000;
  int named = 0, asked = 0, scaled_matrix = 0;
  for (int i = 0; i < kTrials; ++i) {
    Eigen::Matrix3f m;
    Eigen::Vector3f v;
    draw(m), draw(v);
    const float s = number(generator);
    const Eigen::Vector3f bracketed = s * (m * v), p = m * v, by_name = s * p, evaluated = s * (m * v).eval();
    const Eigen::Matrix3f larger = s * m;
    const Eigen::Vector3f by_matrix = larger * v;
    named += bracketed == by_name, asked += evaluated == by_name, scaled_matrix += bracketed == by_matrix;
  }
  std::printf("seen: of %d, %d equal s * p, %d equal (s * M) * v; with eval() %d equal s * p\n", kTrials, named,
              scaled_matrix, asked);
  return scaled_matrix == kTrials && asked == kTrials && named < kTrials / 5 ? 0 : 1;
}
CPP
for level in 0 2; do
  g++ -O$level -ffp-contract=off -I/usr/include/eigen3 "$tmp/t.cpp" -o "$tmp/t" || { echo "not compiled: not looked at"; exit 2; }
  "$tmp/t" || { echo "changed: brackets decide now, or something else does"; exit 1; }
done
echo "as described: the scalar goes into the matrix, whatever the brackets say"
