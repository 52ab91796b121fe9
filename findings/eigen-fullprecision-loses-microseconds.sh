#!/usr/bin/env bash
# Eigen's FullPrecision does not print doubles in full
#
# One would swear: IOFormat(FullPrecision) is what to write states and poses with:
#   reading the text again gives the same doubles.
# What happens: it is digits10, 15 digits for a double (6 for a float), where 17 (9)
#   are needed: 0.1 + 0.2 prints as 0.3, nine of ten random doubles come back as
#   others, and a stamp in seconds keeps five decimals: 1403636579.763555584 is
#   written 1403636579.76356, off by 4.5 microseconds, which moves it past the
#   stamp of a picture that was written with nine.
# What follows: dumps that are to be compared or replayed to the bit use 17
#   digits (max_digits10) or binary; stamps are whole nanoseconds, never in
#   a matrix. A difference of 1e-15 between a run and its replay from a dump is
#   this and no loss of determinism.
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
echo "expected: 1000 of 1000 random doubles come back; the stamp to a double, 0.2 microseconds"
cat >"$tmp/t.cpp" <<'CPP'
#include <Eigen/Core>
#include <cmath>
#include <cstdio>
#include <iomanip>
#include <random>
#include <sstream>
#include <string>

template <class T>
static std::string text(T value) {
  std::ostringstream out;
  out << Eigen::Matrix<T, 1, 1>(value).format(Eigen::IOFormat(Eigen::FullPrecision));
  return out.str();
}

int main() {
  std::mt19937_64 random(1);
  int lost = 0, lost_by_17 = 0;
  for (int i = 0; i < 1000; ++i) {
    const double value = std::generate_canonical<double, 53>(random) * 2 - 1;
    lost += std::stod(text(value)) != value;
    std::ostringstream out;
    out << std::setprecision(17) << value;
    lost_by_17 += std::stod(out.str()) != value;
  }
  int lost_floats = 0;
  for (int i = 0; i < 1000; ++i) {
    const float value = static_cast<float>(std::generate_canonical<double, 53>(random));
    lost_floats += std::stof(text(value)) != value;
  }
  const double stamp = 1403636579.763555584;
  const double off = (std::stod(text(stamp)) - stamp) * 1e6;
  std::printf("seen: %d of 1000 doubles and %d of 1000 floats come back as others (17 digits: %d)\n", lost, lost_floats,
              lost_by_17);
  std::printf("seen: 0.1 + 0.2 is %s; the stamp is %s, off by %.1f microseconds\n", text(0.1 + 0.2).c_str(),
              text(stamp).c_str(), off);
  const bool as_described = lost > 850 && lost_floats > 500 && lost_by_17 == 0 && text(0.1 + 0.2) == "0.3" &&
                            text(stamp) == "1403636579.76356" && std::abs(off - 4.4) < 0.2;
  return as_described ? 0 : 1;
}
CPP
g++ -I/usr/include/eigen3 "$tmp/t.cpp" -o "$tmp/t" 2>"$tmp/cc.log" ||
  { tail -5 "$tmp/cc.log"; echo "cannot be compiled: not looked at"; exit 2; }
"$tmp/t" || { echo "the behaviour has changed"; exit 1; }
