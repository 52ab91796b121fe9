#!/usr/bin/env bash
# In yaml-cpp, giving a node variable a new value rewrites the document
#
# One would swear: Node cam = chain["cam0"]; cam = chain["cam1"]; reads one after the
#   other, as with any handle, iterator or shared pointer: the variable
#   changes, the document does not.
# What happens: the first line makes cam another name of the place cam0; the second
#   writes there. From then on chain["cam0"] is cam1, and a dump shows an
#   anchor and an alias. Nothing is reported. Reset() changes only the
#   variable. Besides, in the same library 010 is 8 as int and 10 as double.
# What follows: code that walks over Kalibr's camchain with one variable and reads
#   it once more later has two right cameras, a baseline of its own and no left
#   one: rectification that is perfect and wrong. A new variable in each
#   round, or Reset. A debugger should print the calibration that the
#   tracker holds, not the file's.
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
want libyaml-cpp-dev 0.7.0
want g++ 4:12
echo "expected: cam0 keeps 458.6 after the variable was given cam1"
cat >"$tmp/t.cpp" <<'CPP'
#include <yaml-cpp/yaml.h>
#include <cstdio>
#include <string>

static const char* const text = "cam0: {fx: 458.6}\ncam1: {fx: 457.5}\n";

int main() {
  const YAML::Node untouched = YAML::Load(text);
  YAML::Node chain = YAML::Load(text);
  YAML::Node cam = chain["cam0"];
  const double first = cam["fx"].as<double>();
  cam = chain["cam1"];
  const double second = cam["fx"].as<double>();
  const double again = chain["cam0"]["fx"].as<double>();
  const std::string dump = YAML::Dump(chain);

  YAML::Node other = YAML::Load(text);
  YAML::Node handle = other["cam0"];
  handle.reset(other["cam1"]);
  const double kept = other["cam0"]["fx"].as<double>();

  const YAML::Node zero = YAML::Load("010");
  std::printf("seen: read %.1f, then %.1f; the document's cam0 is now %.1f, dumped as\n%s\n", first, second, again,
              dump.c_str());
  std::printf("seen: with reset() cam0 stays %.1f; 010 is %d as int, %g as double\n", kept, zero.as<int>(),
              zero.as<double>());
  const bool as_described = first == 458.6 && second == 457.5 && again == 457.5 && kept == 458.6 &&
                            untouched["cam0"]["fx"].as<double>() == 458.6 && dump.find('&') != std::string::npos &&
                            zero.as<int>() == 8 && zero.as<double>() == 10;
  return as_described ? 0 : 1;
}
CPP
g++ -w "$tmp/t.cpp" -o "$tmp/t" -lyaml-cpp 2>"$tmp/cc.log" ||
  { tail -5 "$tmp/cc.log"; echo "cannot be compiled: not looked at"; exit 2; }
"$tmp/t" || { echo "the behaviour has changed"; exit 1; }
