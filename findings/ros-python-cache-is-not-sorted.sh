#!/usr/bin/env bash
# message_filters' Python Cache finds an older message than the newest before a time
#
# One would swear: the Cache keeps messages in order of their stamps, as its C++ twin does: "the
#   newest element before or equal the passed time stamp" is that one, also when two messages came
#   in the wrong order.
# What happens: Python appends as messages come, under a comment that says "Insert sorted", and
#   takes the last of those that are early enough for the newest, the first that is late enough for
#   the oldest. After 1.0, 1.1, 1.3, 1.2, 1.4 and 1.35 the newest up to 1.32 is 1.2, the oldest from
#   1.15 on is 1.3, getLatestTime says 1.35 and getInterval is out of order. In C++ the answers are
#   1.3, 1.2 and 1.4.
# What follows: who looks up depth, IMU samples or poses for a picture in such a node gets a
#   neighbour that is one too early now and then, with no sign of it. Messages come out of order
#   from a node with several threads, from two sources on one topic and from bags, which go by the
#   time of arrival. Sort by header.stamp, and show the distance in time of each pair.
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
want python3-message-filters 1.15.15
want python3-sensor-msgs 1.13.1
want libmessage-filters-dev 1.15.15
want g++ 4:12
echo "expected: newest up to 1.32: 1.3; oldest from 1.15: 1.2; latest: 1.4, in Python and C++"
cat >"$tmp/t.py" <<'PY'
import sys

import message_filters
import rospy
from sensor_msgs.msg import Imu


def time(hundredths):
    return rospy.Time(hundredths // 100, hundredths % 100 * 10**7)


def answers(order):
    cache = message_filters.Cache(message_filters.SimpleFilter(), 100)
    for stamp in order:
        message = Imu()
        message.header.stamp = time(stamp)
        cache.add(message)
    stamp = lambda m: round(m.header.stamp.to_sec(), 2)
    between = [stamp(m) for m in cache.getInterval(time(100), time(200))]
    return (stamp(cache.getElemBeforeTime(time(132))), stamp(cache.getElemAfterTime(time(115))),
            round(cache.getLatestTime().to_sec(), 2), between == sorted(between))


mixed, in_order = answers([100, 110, 130, 120, 140, 135]), answers([100, 110, 120, 130, 135, 140])
for name, seen in (("as they came", mixed), ("come in order", in_order)):
    print(f"seen: Python, {name}: newest up to 1.32: {seen[0]}, oldest from 1.15: {seen[1]}, latest: {seen[2]}, "
          f"interval in order: {seen[3]}")
sys.exit(0 if mixed == (1.2, 1.3, 1.35, False) and in_order == (1.3, 1.2, 1.4, True) else 1)
PY
cat >"$tmp/t.cpp" <<'CPP'
#include <message_filters/cache.h>
#include <message_filters/pass_through.h>
#include <sensor_msgs/Imu.h>

#include <cstdio>

ros::Time time_of(int hundredths) { return ros::Time(hundredths / 100, hundredths % 100 * 10000000); }

int main() {
  ros::Time::init();
  message_filters::PassThrough<sensor_msgs::Imu> source;
  message_filters::Cache<sensor_msgs::Imu> cache(source, 100);
  for (int stamp : {100, 110, 130, 120, 140, 135}) {
    const auto message = boost::make_shared<sensor_msgs::Imu>();
    message->header.stamp = time_of(stamp);
    cache.add(message);
  }
  const ros::Time before = cache.getElemBeforeTime(time_of(132))->header.stamp;
  const ros::Time after = cache.getElemAfterTime(time_of(115))->header.stamp, latest = cache.getLatestTime();
  std::printf("seen: C++, as they came: newest up to 1.32: %g, oldest from 1.15: %g, latest: %g\n", before.toSec(), after.toSec(),
              latest.toSec());
  return before == time_of(130) && after == time_of(120) && latest == time_of(140) ? 0 : 1;
}
CPP
g++ -w -std=c++17 "$tmp/t.cpp" -o "$tmp/t" -lmessage_filters -lroscpp -lrosconsole -lrostime -lboost_thread -lboost_system \
  2>"$tmp/cc.log" || { grep -m3 -E 'error|undefined' "$tmp/cc.log"; echo "cannot be compiled: not looked at"; exit 2; }
/usr/bin/python3 "$tmp/t.py" && "$tmp/t" || { echo "the behaviour has changed"; exit 1; }
echo "as described: Python's Cache is in the order of arrival, and answers as if it were sorted"
