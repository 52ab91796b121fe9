#!/usr/bin/env bash
# ROS' Python reader drops PCL's points of more than half red, or makes them redder
#
# One would swear: skip_nans=True leaves out the points without a position, and what
#   was not left out has the colour that it had.
# What happens: PCL keeps a colour in the bits of a float named rgb, with an alpha of 255
#   that it sets itself. Alpha's last seven bits and red's first one are the exponent of
#   that float: with red from 128 on it is all ones, so the colour reads as NaN.
#   read_points(cloud, skip_nans=True) looks at every field and drops these points: white,
#   yellow, pink and light grey are gone, positions and all. Without skip_nans they
#   come, but a float becomes Python's double on the way, and that sets the first bit
#   of a NaN's fraction, which is red's second bit: red 128 to 191 comes out 64
#   higher, and create_cloud writes it so. Clouds with alpha 0 show nothing of this.
# What follows: clouds in bags are to be read by the bytes of rgb as four octets or as
#   a whole number, never as a float; NaN is to be asked of x, y and z alone. A cloud
#   made by a Python node in which nothing is lighter than mid grey, or in which mid
#   greys are reddish, has been through this, and what is missing there is not what
#   a depth camera missed. In tests of readers, alpha must be 255.
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
want python3-sensor-msgs 1.13.1
want python3-roslib 1.15.8
want libeigen3-dev 3.4.0
want g++ 4:12
# Of PCL the headers are enough, and installing them would bring two hundred packages.
chmod 755 "$tmp" && cd "$tmp"
{ apt-get download -qq libpcl-dev || { apt-get update -qq && apt-get download -qq libpcl-dev; }; } >apt.log 2>&1
dpkg-deb -x libpcl-dev_*.deb pcl 2>>apt.log
pcl=$(dpkg-deb -f "$tmp"/libpcl-dev_*.deb Version 2>/dev/null)
case $pcl in
  1.13.0*) echo "version: libpcl-dev $pcl" ;;
  *) echo "libpcl-dev '$pcl', wanted 1.13.0: not looked at"; exit 2 ;;
esac
echo "expected: of 256 points of red 0 to 255 all are read, each in its own red"
cat >"$tmp/t.cpp" <<'CPP'
#include <cstdio>
#include <pcl/point_types.h>

int main() {  // the points as PCL holds and publishes them: 32 bytes each, rgb at 16
  static_assert(sizeof(pcl::PointXYZRGB) == 32 && offsetof(pcl::PointXYZRGB, rgb) == 16);
  for (int red = 0; red < 256; ++red) {
    pcl::PointXYZRGB point;
    point.x = 0.01F * red, point.y = 0, point.z = 2;
    point.r = red, point.g = 90, point.b = 60;
    std::fwrite(&point, sizeof point, 1, stdout);
  }
}
CPP
g++ -std=c++17 -isystem "$tmp/pcl/usr/include/pcl-1.13" -isystem /usr/include/eigen3 "$tmp/t.cpp" -o "$tmp/t" \
  && "$tmp/t" >"$tmp/points" || { echo "not compiled: not looked at"; exit 2; }
cat >"$tmp/t.py" <<'PY'
import struct
import sys

from sensor_msgs import point_cloud2
from sensor_msgs.msg import PointCloud2, PointField
from std_msgs.msg import Header


def cloud(data):
    fields = [PointField(name, at, PointField.FLOAT32, 1) for name, at in (("x", 0), ("y", 4), ("z", 8), ("rgb", 16))]
    return PointCloud2(header=Header(), height=1, width=256, fields=fields, is_bigendian=False, point_step=32,
                       row_step=len(data), data=data, is_dense=True)


def read(of, **how):
    return list(point_cloud2.read_points(of, **how))


def reds(points):
    return [struct.pack("<f", point[3])[2] for point in points]


data = open(sys.argv[1], "rb").read()
as_pcl, clear = cloud(data), bytearray(data)
clear[19::32] = bytes(256)  # the same with alpha 0
kept, bare = read(as_pcl, skip_nans=True), read(as_pcl, skip_nans=True, field_names=("x", "y", "z"))
all_read = reds(read(as_pcl))
written = point_cloud2.create_cloud(Header(), as_pcl.fields, read(as_pcl))
print(f"seen: alpha {data[19]}; skip_nans=True keeps {len(kept)} of {len(bare)} points with a position, "
      f"the reddest of red {max(reds(kept))}")
moved = [red for red in range(256) if all_read[red] != red]
print(f"seen: without it, {len(moved)} come in another red: {moved[0]} as {all_read[moved[0]]} "
      f"to {moved[-1]} as {all_read[moved[-1]]}")
same = reds(read(cloud(bytes(clear)), skip_nans=True)) == list(range(256))
print(f"seen: with alpha 0, all points in their own reds: {same}")
ok = (reds(kept) == list(range(128)) and len(bare) == 256 and same and moved == list(range(128, 192))
      and all(all_read[red] == red + 64 for red in moved) and list(written.data[18::written.point_step]) == all_read)
sys.exit(0 if ok else 1)
PY
/usr/bin/python3 "$tmp/t.py" "$tmp/points" || { echo "changed: colours are no numbers there any more"; exit 1; }
echo "as described: a colour that looks like NaN costs the point, or 64 steps of red"
