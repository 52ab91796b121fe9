#!/usr/bin/env bash
# GCC 12 leaves out the rounding to float of two numbers that become doubles again
#
# One would swear: a double that is stored in a float has 24 bits from then on, whatever
#   it is converted to later; -O2 and -O3 change no result without -ffast-math.
# What happens: two doubles beside each other that go through a pair of floats, as a point
#   of doubles does through cv::Point2f, come out as they were from -O2 on: the vectoriser
#   makes one conversion each way of them, and both are taken for nothing. With -O1, or
#   with -fno-tree-slp-vectorize, they are rounded; a single number always is.
# What follows: code that is inlined may give other last bits than the same code called,
#   and a debug build others than a release build, where pixels go through single precision
#   on their way. Numbers that are to be the same everywhere keep one precision from end to
#   end; where it changes is in a function that is not inlined, or in memory.
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
want g++ 4:12
[ "$(uname -m)" = x86_64 ] || { echo "not x86-64: not looked at"; exit 2; }
echo "expected: 0.1 and 0.2 rounded to float at every level of optimisation"
cat >"$tmp/t.cpp" <<'CPP'
struct Point {
  float x, y;
};
__attribute__((noinline)) void through_floats(const double* from, double* to) {
  const Point p{static_cast<float>(from[0]), static_cast<float>(from[1])};
  to[0] = static_cast<double>(p.x), to[1] = static_cast<double>(p.y);
}
int main() {
  const double from[2] = {0.1, 0.2};
  double to[2];
  through_floats(from, to);
  if (to[0] == static_cast<double>(0.1F) && to[1] == static_cast<double>(0.2F)) return 0;  // rounded
  return to[0] == 0.1 && to[1] == 0.2 ? 1 : 2;                                             // as they were
}
CPP
seen=
for options in -O0 -O1 -O2 -O3 "-O2 -fno-tree-slp-vectorize"; do
  # shellcheck disable=SC2086
  g++ $options "$tmp/t.cpp" -o "$tmp/t" || { echo "not compiled: not looked at"; exit 2; }
  "$tmp/t"; status=$?
  case $status in 0) word=rounded ;; 1) word="as they were" ;; *) word="something else" ;; esac
  echo "seen: $options: $word"
  seen="$seen$status"
done
[ "$seen" = 00110 ] || { echo "changed: the rounding is left out elsewhere, or nowhere"; exit 1; }
echo "as described: from -O2 on, two doubles go through floats unrounded"
