#!/usr/bin/env bash
# Half of all stamps made from seconds are a nanosecond earlier in ROS' Python than in its C++
#
# One would swear: rospy.Time.from_sec(t) and ros::Time(t) are one stamp for one double t: a
#   colour node in Python and a depth node in C++ that both read the time from a data set's
#   file name, or from a simulated clock, stamp alike.
# What happens: C++ rounds to whole nanoseconds, Python cuts off. A double of today has steps
#   of 238 ns, so what follows the nanosecond is as good as random, and half of the stamps differ
#   by exactly 1 ns. to_sec() of both is the same double, so that printed as seconds they are
#   alike; compared as times they are not equal. 2.3 s of a simulated clock, which starts at 0,
#   is 2.299999999 in Python.
# What follows: exact synchronisers (TimeSynchronizer), joins of bags by header.stamp and
#   lookups by stamp lose half of all pairs, the same ones in each run. Stamps are to be
#   made of whole seconds and nanoseconds that were read as text, and bags by others are to be
#   joined with a microsecond of tolerance.
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
want python3-genpy 0.6.16
want python3-numpy 1:1.24
want libroscpp-core-dev 0.7.2
want librostime1d 0.7.2
want libboost-dev 1.74
want g++ 4:12
cat >"$tmp/t.cpp" <<'CPP'
#include <cstdio>

#include <ros/time.h>

int main() {
  for (double seconds; std::scanf("%lf", &seconds) == 1;) {
    const ros::Time time(seconds);
    std::printf("%u %u %.17g\n", time.sec, time.nsec, time.toSec());
  }
}
CPP
g++ "$tmp/t.cpp" -o "$tmp/stamps" -lrostime 2>"$tmp/errors" || { tail -3 "$tmp/errors"; echo "does not compile: not looked at"; exit 2; }
echo "expected: the same stamp from the same double"
cat >"$tmp/t.py" <<'PY'
import subprocess
import sys

import numpy as np
from genpy import Time

rng = np.random.default_rng(1)
cases = {"stamps of 2011 with six decimals": 1305031102 + np.round(rng.uniform(0, 1000, 4000), 6),
         "a simulated clock's first 100 s in steps of 10 ms": np.arange(1, 10001) / 100.0}
found = {}
for name, seconds in cases.items():
    told = subprocess.run([sys.argv[1]], input="\n".join(repr(float(s)) for s in seconds), capture_output=True, text=True, check=True)
    lines = [line.split() for line in told.stdout.splitlines()]
    in_cpp = [(int(s), int(n)) for s, n, _ in lines]
    python = [Time.from_sec(float(s)) for s in seconds]
    later = np.array([n for _, n in in_cpp]) - [p.nsecs for p in python]
    same_second = [s for s, _ in in_cpp] == [p.secs for p in python]
    same_double = all(float(line[2]) == p.to_sec() == s for line, p, s in zip(lines, python, seconds))
    unequal = np.mean([Time(*c) != p for c, p in zip(in_cpp, python)])
    found[name] = (unequal, same_second, set(later.tolist()), same_double)
    print(f"seen, {name}: {unequal:.1%} differ, C++ less Python in ns: {sorted(found[name][2])}, same seconds: {same_second}, "
          f"to_sec() the same double in both: {same_double}")
one = subprocess.run([sys.argv[1]], input="2.3", capture_output=True, text=True, check=True).stdout.split()
print(f"seen, 2.3 s: C++ {one[0]}.{int(one[1]):09d}, Python {Time.from_sec(2.3).secs}.{Time.from_sec(2.3).nsecs:09d}")
real, simulated = found.values()
ok = 0.45 < real[0] < 0.55 and real[1] and real[2] == {0, 1} and real[3] and simulated[0] > 0.2 and simulated[2] == {0, 1}
ok = ok and (one[1], Time.from_sec(2.3).nsecs) == ("300000000", 299999999)
sys.exit(0 if ok else 1)
PY
/usr/bin/python3 "$tmp/t.py" "$tmp/stamps" || { echo "the behaviour has changed"; exit 1; }
echo "as described: half of the stamps are a nanosecond apart"
