#!/usr/bin/env bash
# pandas reads every third stamp with nine decimals as another double
#
# One would swear: 1305031102.175304123 is one double, whoever parses the text: numpy,
#   Python, C's strtod, and pandas; so tables of an estimate and of the truth
#   that carry the same text can be joined on it.
# What happens: read_csv's usual parser is fast and not exact: of 3000 stamps with nine
#   decimals some 950 come out one step (0.24 microseconds) beside what float()
#   and numpy.loadtxt give. Merging a table read by pandas with one read by
#   numpy, on the stamp, drops those rows: a third of the poses, without a word. With
#   TUM's six decimals all are equal, so that it works in the first tests.
#   float_precision="round_trip" is exact.
# What follows: stamps in what a debugger exports are whole nanoseconds (pandas
#   reads these as int64); joins are by nearest stamp with a tolerance; the recipe for
#   pandas names float_precision. A third of the poses missing in a
#   notebook is this.
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
want python3-pandas 1.5.3
want python3-numpy 1:1.24
echo "expected: the same doubles, 3000 of 3000 rows joined"
cat >"$tmp/t.py" <<'PY'
import io
import random
import sys
import numpy as np
import pandas as pd

random.seed(1)


def table(decimals):
    return [f"{1305031102 + i // 30}.{random.randrange(10 ** decimals):0{decimals}d}" for i in range(3000)]


def by_pandas(texts, **how):
    return pd.read_csv(io.StringIO("stamp\n" + "\n".join(texts)), **how)["stamp"].to_numpy()


seen = {}
for decimals in (6, 9):
    texts = sorted(set(table(decimals)))
    exact = np.array([float(t) for t in texts])
    numpys = np.loadtxt(io.StringIO("\n".join(texts)))
    usual, asked = by_pandas(texts), by_pandas(texts, float_precision="round_trip")
    joined = len(pd.merge(pd.DataFrame({"t": usual, "a": 1}), pd.DataFrame({"t": numpys, "b": 2}), on="t"))
    seen[decimals] = [len(texts), int((usual != exact).sum()), int((numpys != exact).sum()), int((asked != exact).sum()), joined]
    print(f"seen: {decimals} decimals: of {len(texts)} stamps pandas has {seen[decimals][1]} others, at most "
          f"{np.abs(usual - exact).max() * 1e6:.2f} microseconds off; numpy {seen[decimals][2]}; "
          f"round_trip {seen[decimals][3]}; joined rows {joined}")
n6, n9 = seen[6], seen[9]
ok = (n6[1:4] == [0, 0, 0] and n6[4] == n6[0] and 800 < n9[1] < 1100 and n9[2:4] == [0, 0]
      and n9[4] < n9[0] - 800)
sys.exit(0 if ok else 1)
PY
(cd "$tmp" && /usr/bin/python3 t.py) || { echo "the behaviour has changed"; exit 1; }
