#!/usr/bin/env bash
# gpsbabel gives each GPS fix the time of the next one: a second late, for receivers that send RMC first
#
# One would swear: every RMC and every GGA sentence says its own time of day, to the hundredth, and
#   both sentences of one epoch say the same one; so a position comes out with the time it was sent
#   with, whatever the order of the sentences.
# What happens: if RMC comes before GGA, as with receivers that send RMC, VTG, GGA, GSA, GSV, GLL, the
#   first point is made of the RMC alone, and from then on the position and the height of a GGA are
#   written out with the time of the RMC that follows. At 1 Hz the track is one second late
#   throughout, at 5 Hz a fifth; the first position is there twice, the last one is gone. With GGA
#   before RMC the same fixes come out right. Nothing is said, and all numbers look right; at 10 m/s
#   it is 10 m. With gpgga=0 the times are right, and the heights are gone.
# What follows: a ground truth that came from NMEA through gpsbabel (GPX, KML, CSV) may lie one GPS
#   period behind the pictures: ask for the order of the sentences, and check by the first two
#   positions being the same. Convert with gpgga=0, or bring GGA to the front. A time offset of
#   exactly one GPS period between truth and estimate is this, and no clock.
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
want gpsbabel 1.8.0
want python3 3.11
echo "expected: the n-th fix with the n-th time, in any order of sentences"
cat >"$tmp/t.py" <<'PY'
import re
import subprocess
import sys

fixes = 8


def sentence(text):
    check = 0
    for c in text:
        check ^= ord(c)
    return f"${text}*{check:02X}\r\n"


# A vehicle that goes north by a thousandth of a minute (1.85 m) and up by 1 m from fix to fix.
def log(step, order):
    text = ""
    for i in range(fixes):
        clock = f"1200{i * step:05.2f}"
        where = f"48{6 + i * 0.001:08.5f},N,01130.00000,E"
        rmc = sentence(f"GNRMC,{clock},A,{where},3.6,0.0,100511,,,A")
        gga = sentence(f"GNGGA,{clock},{where},1,08,0.90,{500 + i}.0,M,46.9,M,,")
        gll = sentence(f"GNGLL,{where},{clock},A,A")
        vtg = sentence("GNVTG,0.0,T,,M,3.6,N,6.7,K,A")
        text += rmc + vtg + gga + gll if order == "RMC first" else gga + vtg + rmc + gll
    return text


# For each point that comes out: which fix its position is, and which its time is.
def convert(step, order, options=""):
    run = subprocess.run(["gpsbabel", "-t", "-i", "nmea" + options, "-f", "-", "-o", "gpx", "-F", "-"],
                         input=log(step, order), capture_output=True, text=True)
    found = []
    for latitude, rest in re.findall(r'<trkpt lat="([\d.]+)"(.*?)</trkpt>', run.stdout, re.S):
        second = float(re.search(r"T12:00:([\d.]+)Z", rest)[1])
        found.append((round((float(latitude) - 48.1) * 60 / 0.001), round(second / step), "<ele>" in rest))
    return found, run.stderr.strip()


right = [(i, i) for i in range(fixes)]
late = [(0, 0)] + [(i - 1, i) for i in range(1, fixes)]
ok = True
for step in (1, 0.2):
    for order, options, wanted in (("RMC first", "", late), ("GGA first", "", right), ("RMC first", ",gpgga=0", right)):
        found, said = convert(step, order, options)
        pairs, heights = [f[:2] for f in found], sum(f[2] for f in found)
        print(f"seen, {step} s, {order}{options}: position and time of fix", *(f"{p}@{t}" for p, t in pairs),
              f"({heights} heights, said: {said or 'nothing'})")
        ok = ok and pairs == wanted and not said
sys.exit(0 if ok else 1)
PY
/usr/bin/python3 "$tmp/t.py" || { echo "the behaviour has changed"; exit 1; }
echo "as described: with RMC first every position has the time of the next"
