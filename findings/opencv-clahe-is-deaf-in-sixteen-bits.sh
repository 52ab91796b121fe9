#!/usr/bin/env bash
# cv::CLAHE does not hear its clip limit on a 16-bit picture
#
# One would swear: clipLimit says how many times local contrast is raised at most; 2 is gentle,
#   20 is not, and a 16-bit picture comes out as its 8-bit version does, in finer steps.
# What happens: a histogram of 16 bits has 65536 bins, and what a bin may hold is clipLimit *
#   pixels of a tile / bins, cut down to a whole number and at least 1. In the tiles of 80 x 60
#   of a 640 x 480 picture that is 1 for every clipLimit up to 27: all of them give the same
#   picture, bit for bit, and 28 to 40 the next. One pixel a bin allows a slope of 65535 / 4800:
#   13.7 times where 2 was asked for. Texture that 8 bits raise 2.3 times at 2 is raised 6.4
#   times in 16 bits, and 11.5 times if it lies in twelve of them.
# What follows: 16-bit pictures (TUM-VI's, thermal cameras') that are tracked after CLAHE have
#   their noise raised as if the limit were 14, and a sweep over it finds that it does not
#   matter. To 8 bits first, then CLAHE.
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
want python3-opencv 4.6.0
echo "expected: contrast raised about twice at clipLimit 2, more at each larger one, in 16 bits as in 8"
cat >"$tmp/t.py" <<'PY'
import sys

import cv2
import numpy as np

noise = np.random.default_rng(1).normal(size=(480, 640))
texture = cv2.GaussianBlur(noise, (0, 0), 2)
texture /= texture.std()
wide = (30000 + 6000 * np.sin(np.arange(640) / 60) + 300 * texture).round().astype(np.uint16)
narrow = (wide // 16).astype(np.uint16)  # twelve bits in sixteen
bytes_ = (wide / 257).round().astype(np.uint8)


def raised(picture, limit):  # the texture's standard deviation within 9 x 9 pixels, after and before
    after = cv2.createCLAHE(limit, (8, 8)).apply(picture)
    local = lambda p: np.median(np.sqrt(np.maximum(0, cv2.blur(p * p, (9, 9)) - cv2.blur(p, (9, 9)) ** 2)))
    return local(after.astype(float)) / local(picture.astype(float)), after


limits = [1, 2, 4, 8, 16, 27, 28, 40, 41]
seen = {name: [raised(p, limit) for limit in limits] for name, p in (("16 bits", wide), ("12 in 16", narrow), ("8 bits", bytes_))}
for name, found in seen.items():
    print(f"seen, {name}, raised at " + ", ".join(f"{limit}: {times:.1f}" for limit, (times, _) in zip(limits, found)))
same = {name: [np.array_equal(found[0][1], after) for _, after in found] for name, found in seen.items()}
print("seen, the same picture bit for bit as at 1:", "; ".join(f"{name} up to {limits[sum(s) - 1]}" for name, s in same.items()))
steps = [limit for limit in range(1, 101) if (limit * 4800) // 65536 > ((limit - 1) * 4800) // 65536 and limit * 4800 // 65536 > 1]
heard = [limit for limit in range(2, 101)
         if not np.array_equal(cv2.createCLAHE(limit, (8, 8)).apply(wide), cv2.createCLAHE(limit - 1, (8, 8)).apply(wide))]
print(f"seen, of all limits to 100 those that change anything: {heard}; where limit * 4800 / 65536 passes a whole number: {steps}")
ok = all(same[name] == [True] * 6 + [False] * 3 for name in ("16 bits", "12 in 16")) and sum(same["8 bits"]) == 1 and heard == steps
ok = ok and seen["16 bits"][1][0] > 5 and seen["12 in 16"][1][0] > 5 and seen["8 bits"][1][0] < 3 and 65535 / 4800 > 13.6
sys.exit(0 if ok else 1)
PY
/usr/bin/python3 "$tmp/t.py" || { echo "the behaviour has changed"; exit 1; }
echo "as described: below 28 there is one limit"
