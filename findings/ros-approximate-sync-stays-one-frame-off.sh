#!/usr/bin/env bash
# message_filters' Python synchronizer never recovers from one lost colour frame
#
# One would swear: ApproximateTimeSynchronizer pairs each picture with the nearest
#   depth within the slop; a lost message costs one pair.
# What happens: a pair goes out as soon as any partner within the slop is there,
#   and both are taken off. With depth 2 ms after colour at 30 Hz and a slop above
#   31 ms (0.1 s is often written), one lost colour message leaves its depth
#   behind; the next picture arrives first, takes the old depth 31 ms away, and
#   leaves its own, and so on to the end of the bag. With a slop below 31 ms, or
#   when it is a depth message that was lost, nothing of that happens.
# What follows: pairs made by such a node can be one depth frame late from some
#   moment on: the films look right, and only moving cameras have doubled edges.
#   A debugger that reads bags must pair by itself, by nearest stamp, and must
#   show the distance in time of each pair: a step from 2 ms to 31 ms that stays is
#   this.
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
want python3-rospy 1.15.15
echo "expected: after the lost message every picture has the depth 2 ms after it"
cat >"$tmp/t.py" <<'PY'
import sys
import rospy
import message_filters

rospy.rostime.set_rostime_initialized(True)  # stamps only; no node, no master


class Message:
    def __init__(self, seconds):
        self.header = type("Header", (), {})()
        self.header.stamp = rospy.Time.from_sec(1000 + seconds)


def gaps(slop, lost_colour=None, lost_depth=None, n=60):
    colour, depth, out = message_filters.SimpleFilter(), message_filters.SimpleFilter(), []
    sync = message_filters.ApproximateTimeSynchronizer([colour, depth], 10, slop)
    sync.registerCallback(lambda a, b: out.append(round((b.header.stamp - a.header.stamp).to_sec() * 1000)))
    for i in range(n):
        if i != lost_colour:
            colour.signalMessage(Message(i / 30))
        if i != lost_depth:
            depth.signalMessage(Message(i / 30 + 0.002))
    return out


whole, lost, narrow, other = gaps(0.1), gaps(0.1, lost_colour=3), gaps(0.02, lost_colour=3), gaps(0.1, lost_depth=3)
print(f"seen: nothing lost, slop 0.1: depth minus colour {sorted(set(whole))} ms in {len(whole)} pairs")
print(f"seen: colour 3 lost, slop 0.1: {lost[:3]} ms, then {sorted(set(lost[3:]))} ms in all {len(lost) - 3} later pairs")
print(f"seen: colour 3 lost, slop 0.02: {sorted(set(narrow))} ms; depth 3 lost, slop 0.1: {sorted(set(other))} ms")
ok = (set(whole) == {2} and lost[:3] == [2, 2, 2] and set(lost[3:]) == {-31} and len(lost) == 59
      and set(narrow) == {2} and set(other) == {2})
sys.exit(0 if ok else 1)
PY
(cd "$tmp" && /usr/bin/python3 t.py) || { echo "the behaviour has changed"; exit 1; }
