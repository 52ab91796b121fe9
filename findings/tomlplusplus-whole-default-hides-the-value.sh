#!/usr/bin/env bash
# toml++: a default written 525 hides a focal length of 517.3
#
# One would swear: value_or(525) gives the file's number, converted to int at
#   worst (517), and the default only where the key is missing.
# What happens: the type of the default is the type asked for, and a number that does
#   not fit into it counts as missing. fx = 517.3 gives 525, silently; written
#   525.0, it gives 517.3. The other way fits (500 read by 525.0 is 500), and so
#   does 500.0 by 525: the reader works on some files and takes the
#   default on others. A quoted "517.3" is missing as well.
# What follows: settings are read by a function that tells "missing" from "of
#   another kind" and refuses the second; the settings that a run used are
#   written out beside its results. A calibration that happens to equal a
#   program's default is suspicious.
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
want libtomlplusplus-dev 3.3.0
want g++ 4:12
echo "expected: 517 (or 517.3) in each case"
cat >"$tmp/t.cpp" <<'CPP'
#include <toml++/toml.h>
#include <cstdio>

int main() {
  const toml::table t = toml::parse("fx = 517.3\nround = 500.0\nwhole = 500\nquoted = \"517.3\"\n");
  const int hidden = t["fx"].value_or(525);
  const double right = t["fx"].value_or(525.0);
  const int round = t["round"].value_or(525);
  const double whole = t["whole"].value_or(525.0);
  const double quoted = t["quoted"].value_or(525.0);
  std::printf("seen: fx = 517.3 by value_or(525) is %d, by value_or(525.0) %g\n", hidden, right);
  std::printf("seen: 500.0 by value_or(525) is %d, 500 by value_or(525.0) %g, \"517.3\" by value_or(525.0) %g\n", round,
              whole, quoted);
  return hidden == 525 && right == 517.3 && round == 500 && whole == 500 && quoted == 525 ? 0 : 1;
}
CPP
g++ -std=c++17 -w "$tmp/t.cpp" -o "$tmp/t" 2>"$tmp/cc.log" ||
  { tail -5 "$tmp/cc.log"; echo "cannot be compiled: not looked at"; exit 2; }
"$tmp/t" || { echo "the behaviour has changed"; exit 1; }
