#!/usr/bin/env bash
# A patch of a depth picture does not match itself in cv::matchTemplate
#
# One would swear: normalized cross-correlation does not depend on brightness: a patch cut out
#   of a float picture scores 1 where it was cut out, and nowhere more, whatever the offset.
# What happens: the correlation is kept as float, and the product of the means is taken off only
#   then: of 1e9 for 121 pixels at 3000 a float knows steps of 128, while the relief of a wall
#   is worth some 1000. Of a wall at 3 m with 3 mm of relief, patches in millimetres score from
#   0.89 to 1 on themselves, and one in eight is found elsewhere; with 1 mm at 5 m all are, and
#   thousands of places score exactly 1. In metres there is a second thing: a window whose
#   variance is less than 1.2e-6 of its mean square counts as flat and scores 0, as four in five
#   of that wall's do (numbers as large as millimetres are spared: the limit is at most 0.5 for
#   the sum). With a constant near the mean taken off both, all patches score 1.
# What follows: depth, thermal pictures and other float pictures with little contrast on a
#   large offset must have it taken off before matchTemplate (which has no 16-bit input,
#   so that they all come as float). Scores of exactly 1 in several places are the sign of it.
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
echo "expected: each of 40 patches found where it was cut out, with a score of 1"
cat >"$tmp/t.py" <<'PY'
import sys

import cv2
import numpy as np


def wall(offset, relief, unit):
    noise = cv2.GaussianBlur(np.random.default_rng(1).normal(size=(240, 320)), (0, 0), 1.5)
    return ((offset + relief * noise / noise.std()).round() * unit).astype(np.float32)


def found(picture):
    """Of 40 patches: how many at their place, the least score there, the most places that score 1; who is flat, who scores 0."""
    rng, right, scores, ones, flat = np.random.default_rng(2), 0, [], 0, []
    for _ in range(40):
        row, column = rng.integers(0, 240 - 11), rng.integers(0, 320 - 11)
        patch = picture[row:row + 11, column:column + 11].copy()
        score = cv2.matchTemplate(picture, patch, cv2.TM_CCOEFF_NORMED)
        right += np.unravel_index(score.argmax(), score.shape) == (row, column)
        scores.append(score[row, column])
        ones = max(ones, int((score == 1).sum()))
        squares = np.sum(patch.astype(float) ** 2)
        flat.append(patch.size * patch.astype(float).var() <= min(0.5, 10 * np.finfo(np.float32).eps * squares))
    return int(right), float(min(scores)), ones, flat, [s == 0 for s in scores]


def say(name, result):
    print(f"seen, {name}: {result[0]} of 40 at their place, the least score there {result[1]:.3f}, places with a score of exactly 1: up to {result[2]}")
    return result


three = say("3000 mm with 3 mm of relief", found(wall(3000, 3, 1)))
metres = say("the same in metres", found(wall(3000, 3, 0.001)))
five = say("5000 mm with 1 mm", found(wall(5000, 1, 1)))
near = say("5000 mm with 1 mm, less 4990", found(wall(5000, 1, 1) - np.float32(4990)))
strong = say("5000 mm with 100 mm", found(wall(5000, 100, 1)))
print(f"seen in metres: {sum(metres[4])} score 0; {sum(metres[3])} have a variance below 1.2e-6 of their mean square; the same ones: {metres[3] == metres[4]}")
ok = 30 <= three[0] < 40 and 0.85 < three[1] < 0.95 and not any(three[3] + three[4]) and five[0] < 5 and five[1] < 0.5 and five[2] > 1000
ok = ok and metres[0] < 20 and 10 < sum(metres[3]) < 40 and metres[3] == metres[4]
ok = ok and near[0] == strong[0] == 40 and near[1] > 0.999 and strong[1] > 0.999
sys.exit(0 if ok else 1)
PY
/usr/bin/python3 "$tmp/t.py" || { echo "the behaviour has changed"; exit 1; }
echo "as described: the offset is taken off too late"
