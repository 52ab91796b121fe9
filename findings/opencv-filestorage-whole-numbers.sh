#!/usr/bin/env bash
# cv::FileStorage keeps 32 bits of a whole number, and reads 010 as eight
#
# One would swear: a number without a point in a YAML, JSON or XML file, asked for as
#   double, comes as that number, or the reading fails when it is too large.
# What happens: it is kept as a 32-bit int, silently. A stamp of EuRoC,
#   1403636579763555584, is read as 1384975616; 3000000000 as -1294967296. In
#   a matrix of doubles too. A leading zero means octal, in XML also. With ".0" at
#   the end all are right. PyYAML reads the stamp whole.
# What follows: settings in OpenCV's YAML (ORB-SLAM's, Kalibr's converted) must not
#   be read by FileStorage where a value can pass two thousand million: stamps
#   and offsets in nanoseconds, first of all. A debugger that writes such files
#   for others writes stamps as text or with a point.
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
want python3-yaml 6.0
echo "expected: 1403636579763555584 to the precision of a double, 3000000000, and 10 where no format says octal"
cat >"$tmp/t.py" <<'PY'
import sys
import cv2
import yaml

texts = ["1403636579763555584", "3000000000", "1403636579763555584.0"]
files = {
    "a.yml": "%YAML:1.0\n---\n" + "".join(f"v{i}: {t}\n" for i, t in enumerate(texts))
             + "matrix: !!opencv-matrix\n   rows: 1\n   cols: 2\n   dt: d\n   data: [ 3000000000, 2.5 ]\nzero: 010\n",
    "a.json": "{" + ", ".join(f'"v{i}": {t}' for i, t in enumerate(texts)) + "}",
    "a.xml": '<?xml version="1.0"?>\n<opencv_storage>'
             + "".join(f"<v{i}>{t}</v{i}>" for i, t in enumerate(texts)) + "<zero>010</zero></opencv_storage>\n",
}
seen, octal = {}, {}
for name, text in files.items():
    with open(name, "w") as out:
        out.write(text)
    storage = cv2.FileStorage(name, cv2.FILE_STORAGE_READ)
    seen[name] = [storage.getNode(f"v{i}").real() for i in range(len(texts))]
    print(f"seen: {name}: " + ", ".join(f"{t} is {v:.0f}" for t, v in zip(texts, seen[name])))
    if name == "a.yml":
        matrix = storage.getNode("matrix").mat().ravel().tolist()
        print(f"seen: {name}: a matrix of doubles: 3000000000, 2.5 are {matrix}")
    if name != "a.json":
        octal[name] = storage.getNode("zero").real()
        print(f"seen: {name}: 010 is {octal[name]:.0f}")
theirs = yaml.safe_load("\n".join(files["a.yml"].split("\n")[2:4]))
print(f"seen: PyYAML: {theirs['v0']}, {theirs['v1']}")
ok = (all(v == [1384975616.0, -1294967296.0, 1403636579763555584.0] for v in seen.values())
      and matrix == [-1294967296.0, 2.5] and octal == {"a.yml": 8.0, "a.xml": 8.0}
      and theirs["v0"] == 1403636579763555584 and theirs["v1"] == 3000000000)
sys.exit(0 if ok else 1)
PY
(cd "$tmp" && /usr/bin/python3 t.py) || { echo "the behaviour has changed"; exit 1; }
