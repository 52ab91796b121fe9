#!/usr/bin/env bash
# A numpy stamp asked of a rosbag2 file finds no message after it, and all before it
#
# One would swear: "SELECT ... WHERE timestamp >= ?" with a number out of a numpy array of
#   nanoseconds compares numbers, or sqlite3 says that it does not know the type.
# What happens: numpy.int64 is no Python int, but it can be read as bytes, and so Python's
#   sqlite3 binds it as a BLOB of eight bytes, as it does int32, uint64, float32 and bool_; only
#   float64 is a Python float. To SQLite any number is smaller than any BLOB: >=, = and BETWEEN
#   find nothing, <= finds everything, and there is no error. Written into an INTEGER column it
#   stays a BLOB, which sorts behind all messages and is max(timestamp). int(stamp) is right.
# What follows: whoever cuts a .db3 bag by stamps out of numpy or pandas gets an empty sequence
#   or the whole one. A reader of such files should ask typeof(timestamp) once and say what it
#   found, as a bag that a script has written may hold stamps of both kinds.
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
want python3 3.11
want python3-numpy 1:1.24
echo "expected: 3 messages from the third on, 3 up to it, 1 at it, or a refusal"
cat >"$tmp/t.py" <<'PY'
import sqlite3
import sys

import numpy as np

first = 1700000000123456789
bag = sqlite3.connect(":memory:")
bag.execute("CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, timestamp INTEGER NOT NULL, data BLOB NOT NULL)")
bag.executemany("INSERT INTO messages(topic_id, timestamp, data) VALUES(1, ?, x'00')", [(first + 33333333 * i,) for i in range(5)])
stamps = first + 33333333 * np.arange(5)


def count(where, *values):
    return bag.execute("SELECT count(*) FROM messages WHERE " + where, values).fetchone()[0]


def asked(stamp):
    return [count("timestamp >= ?", stamp), count("timestamp <= ?", stamp), count("timestamp = ?", stamp),
            count("timestamp BETWEEN ? AND ?", stamp, stamp)]


by_numpy, by_int = asked(stamps[2]), asked(int(stamps[2]))
print(f"seen, from, up to, at and between the third stamp: numpy.int64 {by_numpy}, int {by_int}")
kinds = {kind: bag.execute("SELECT typeof(?)", (getattr(np, kind)(1),)).fetchone()[0]
         for kind in ("int64", "int32", "uint64", "float32", "bool_", "float64")}
print("seen, bound as:", ", ".join(f"{kind} {how}" for kind, how in kinds.items()))
bag.execute("INSERT INTO messages(topic_id, timestamp, data) VALUES(1, ?, x'00')", (stamps[0] - 1,))  # earlier than all
last = bag.execute("SELECT typeof(timestamp), id FROM messages ORDER BY timestamp DESC LIMIT 1").fetchone()
largest = bag.execute("SELECT max(timestamp) FROM messages").fetchone()[0]
print(f"seen, a sixth message, stamped before the first by numpy: the last by stamp is number {last[1]}, of type {last[0]}; max is {largest!r}")
ok = by_numpy == [0, 5, 0, 0] and by_int == [3, 3, 1, 1] and set(kinds.values()) == {"blob", "real"} and kinds["float64"] == "real"
sys.exit(0 if ok and last == ("blob", 6) and largest == int(stamps[0] - 1).to_bytes(8, sys.byteorder) else 1)
PY
/usr/bin/python3 "$tmp/t.py" || { echo "the behaviour has changed"; exit 1; }
echo "as described: numbers of numpy are bytes to sqlite3"
