#!/usr/bin/env bash
# Miller and gnuplot's stats find 9 ppm of drift between two clocks that drift by 20
#
# One would swear: a line through the stamps of a camera and the offsets of an IMU's, ten minutes at
#   30 Hz and no noise, has the slope that is there; mlr stats2 -a linreg-ols and gnuplot's stats
#   reckon in doubles, which know Unix seconds to a quarter of a microsecond.
# What happens: both subtract sums of squares that are alike in all but their last digits. Of 20 ppm
#   they find 9.3 each, a number that looks like a drift. Of one clock over the other, whose slope is
#   1.00002, both make 0.72, mlr with an r2 of 1.15 and a correlation of 1.07. mlr's stddev of ten
#   minutes of stamps is 254 s for 173, of 20 s of them 0. Nothing is said. Seconds from the first row
#   are right in both, and so are, over Unix seconds, gnuplot's STATS_stddev_x and datamash's sstdev
#   and pcov.
# What follows: take the first stamp off before any statistic (mlr put '$cam -= 1403636579' in the
#   same call). A correlation of more than 1 is this; a drift of half its size shows nothing.
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
want miller 6.6.0
want gnuplot-nox 5.4.4
want datamash 1.7
want python3 3.11
echo "expected: 20 ppm, a slope of 1.00002, a standard deviation of 173.2 s"
cat >"$tmp/t.py" <<'PY'
import subprocess
import sys


def run(*command):
    return subprocess.run(command, check=True, capture_output=True, text=True)


def look(start, count=18000):
    rows = [(start + i / 30, start + i / 30 + 0.005 + 20e-6 * i / 30) for i in range(count)]
    with open("clocks.csv", "w") as out:
        out.write("cam,imu\n" + "".join(f"{a:.9f},{b:.9f}\n" for a, b in rows))
    mlr = lambda *verbs: {k: float(v) for k, v in map(str.split, run("mlr", "--icsv", "--oxtab", *verbs, "clocks.csv").stdout.splitlines())}
    over = mlr("stats2", "-a", "linreg-ols,r2,corr", "-f", "cam,imu")
    drift = mlr("put", "$d = $imu - $cam", "then", "stats2", "-a", "linreg-ols", "-f", "cam,d")["cam_d_ols_m"]
    spread = mlr("stats1", "-a", "stddev", "-f", "cam")["cam_stddev"]
    plot = [float(v) for v in run("gnuplot", "-e", "set datafile separator ','; set print '-'; stats 'clocks.csv' skip 1 using 1:2 nooutput; "
            "print STATS_slope, STATS_stddev_x; stats 'clocks.csv' skip 1 using 1:($2-$1) nooutput; print STATS_slope").stdout.split()]
    mash = subprocess.run(["datamash", "-t,", "--header-in", "sstdev", "1", "pcov", "1:2", "pvar", "1"], stdin=open("clocks.csv"), check=True,
                          capture_output=True, text=True).stdout.strip().split(",")
    sd, cov, var = map(float, mash)
    seen = {"drift": drift * 1e6, "slope": over["cam_imu_ols_m"], "r2": over["cam_imu_r2"], "corr": over["cam_imu_corr"], "stddev": spread,
            "plot drift": plot[2] * 1e6, "plot slope": plot[0], "plot stddev": plot[1], "datamash slope": cov / var, "datamash stddev": sd}
    print(f"seen, {count} rows from {start:.3f} s: mlr drift {seen['drift']:.2f} ppm, slope {seen['slope']:.6f}, r2 {seen['r2']:.3f}, "
          f"corr {seen['corr']:.3f}, stddev {spread:.2f}; gnuplot drift {seen['plot drift']:.2f} ppm, slope {plot[0]:.6f}, stddev {plot[1]:.2f}; "
          f"datamash slope {cov / var:.6f}, stddev {sd:.2f}")
    return seen


unix, zero, short = look(1403636579.763555), look(0.0), look(1403636579.763555, 600)
near = lambda a, b, e: abs(a - b) <= e
right = lambda s: near(s["plot stddev"], 173.2, 0.1) and near(s["datamash slope"], 1.00002, 1e-6) and near(s["datamash stddev"], 173.2, 0.1)
ok = right(unix) and right(zero) and all(5 < unix[k] < 14 for k in ("drift", "plot drift"))
ok = ok and all(0.5 < unix[k] < 0.95 for k in ("slope", "plot slope")) and unix["r2"] > 1.02 and unix["corr"] > 1.02 and unix["stddev"] > 220
ok = ok and all(near(zero[k], 20, 0.01) for k in ("drift", "plot drift")) and near(zero["slope"], 1.00002, 1e-7) and near(zero["plot slope"], 1.00002, 1e-7)
ok = ok and near(zero["corr"], 1, 1e-6) and near(zero["stddev"], 173.2, 0.1) and short["stddev"] == 0 and near(short["plot stddev"], 5.77, 0.01)
sys.exit(0 if ok else 1)
PY
(cd "$tmp" && nice /usr/bin/python3 t.py) || { echo "the behaviour has changed"; exit 1; }
echo "as described: over Unix seconds slopes are chance"
