#!/usr/bin/env bash
# A suite whose set-up fails counts as skipped under ctest, and the run passes
#
# One would swear: an ASSERT that fails in SetUpTestSuite fails the suite's tests,
#   and ctest with gtest_discover_tests, CMake's own way, says so and ends with
#   status 8.
# What happens: gtest reports the failure once, outside any test, and marks every
#   test of the suite SKIPPED; only the program's own exit status tells. But
#   gtest_discover_tests gives each test SKIP_REGULAR_EXPRESSION
#   "[  SKIPPED ]", and ctest looks at that before it looks at the exit status: each
#   test is "Skipped", and ctest ends with "100% tests passed" and status 0. A
#   failing ASSERT in the test itself is reported as one would expect.
# What follows: tests whose shared sequence could not even be rendered stay green for
#   as long as nobody reads the list of skipped ones. Let the gtest program run as one
#   ctest test a suite (add_test with --gtest_filter, without a skip expression), so
#   that its exit status counts; or assert in SetUp what SetUpTestSuite made.
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
want libgtest-dev 1.12.1
want cmake 3.25.1
want g++ 4:12
want make 4.3
echo "expected: ctest fails by the suite whose set-up fails"
cat >"$tmp/CMakeLists.txt" <<'CMAKE'
cmake_minimum_required(VERSION 3.25)
project(t CXX)
enable_testing()
find_package(GTest REQUIRED)
include(GoogleTest)
add_executable(t t.cpp)
target_link_libraries(t GTest::gtest_main)
gtest_discover_tests(t)
CMAKE
cat >"$tmp/t.cpp" <<'CPP'
#include <gtest/gtest.h>
class Shared : public testing::Test {
 protected:
  static void SetUpTestSuite() { ASSERT_TRUE(false) << "the shared sequence is not there"; }
};
TEST_F(Shared, First) { EXPECT_TRUE(true); }
TEST_F(Shared, Second) { EXPECT_TRUE(true); }
#ifdef OWN
TEST(Own, Fails) { ASSERT_TRUE(false); }
#endif
CPP
build() { cmake -S "$tmp" -B "$tmp/$1" -DCMAKE_CXX_FLAGS="$2" && cmake --build "$tmp/$1"; }
build a "" >"$tmp/a.log" 2>&1 && build b -DOWN >"$tmp/b.log" 2>&1 || { tail -5 "$tmp"/?.log; exit 2; }
"$tmp/a/t" >"$tmp/own.log" 2>&1
own=$?
(cd "$tmp/a" && ctest) >"$tmp/ctest.log" 2>&1
all=$?
(cd "$tmp/b" && ctest) >"$tmp/control.log" 2>&1
control=$?
skipped=$(grep -c 'Skipped *[0-9]' "$tmp/ctest.log")
echo "seen: the program itself ends with $own; ctest skips $skipped of 2 tests, says '$(grep -o '^[0-9]*% tests passed' "$tmp/ctest.log")' and ends with $all;"
echo "      with a test that fails by itself beside them ctest ends with $control"
if [ "$own" = 1 ] && [ "$all" = 0 ] && [ "$skipped" = 2 ] && [ "$control" = 8 ]; then
  echo "still so"
else
  echo "has changed"
  cat "$tmp/ctest.log"
  exit 1
fi
