#!/usr/bin/env bash
# tf2 turns the points of a cloud and leaves their normals as they were, in C++ and in Python
#
# One would swear: to transform a PointCloud2 into another frame is to transform what is in it that
#   has a direction: x y z, and normal_x normal_y normal_z, which are the names that PCL and ROS
#   give to normals; the shape of the cloud stays.
# What happens: doTransform and do_transform_cloud of tf2_sensor_msgs take x, y and z and copy the
#   rest. A wall that is looked at along z has the normal (0, 0, -1) in the camera's frame; in a map
#   in which the camera looks along x its points are right and the normal is still (0, 0, -1): 90
#   degrees off, along the wall instead of out of it. viewpoints (vp_x, vp_y, vp_z) stay in the
#   camera's frame too. The frame_id says map. And Python makes one row of an organized cloud, 12 x
#   1 of 4 x 3, where C++ keeps 4 x 3.
# What follows: normals are to be estimated after the transform or turned by hand; point-to-plane
#   ICP and surfels that are fed by tf drift as soon as the camera has turned, and not before. It is
#   seen by looking at one point's normal, and by no test of a camera that only moves.
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
want libtf2-sensor-msgs-dev 0.7.6
want python3-tf2-sensor-msgs 0.7.6
want g++ 4:12
cd "$tmp" || exit 2
echo "expected: points and normals turned by 90 degrees, 4 x 3 as before"
cat >t.cpp <<'CPP'
#include <cmath>
#include <cstdio>

#include <sensor_msgs/point_cloud2_iterator.h>
#include <tf2_sensor_msgs/tf2_sensor_msgs.h>

int main() {
  sensor_msgs::PointCloud2 in, out;
  in.header.frame_id = "camera";
  sensor_msgs::PointCloud2Modifier fields(in);
  fields.setPointCloud2Fields(9, "x", 1, 7, "y", 1, 7, "z", 1, 7, "normal_x", 1, 7, "normal_y", 1, 7, "normal_z", 1, 7, "vp_x", 1, 7, "vp_y", 1, 7,
                              "vp_z", 1, 7);
  fields.resize(12);
  in.height = 3, in.width = 4, in.row_step = in.width * in.point_step;
  sensor_msgs::PointCloud2Iterator<float> x(in, "x");
  for (int i = 0; i < 12; ++i, ++x) {
    const float point[9] = {0.1f * (i % 4), 0.1f * (i / 4), 2, 0, 0, -1, 0, 0, 0};
    for (int k = 0; k < 9; ++k) x[k] = point[k];
  }
  geometry_msgs::TransformStamped pose;  // the camera's z is the map's x
  pose.header.frame_id = "map";
  pose.transform.translation.x = 10;
  pose.transform.rotation.y = pose.transform.rotation.w = std::sqrt(0.5);
  tf2::doTransform(in, out, pose);
  sensor_msgs::PointCloud2Iterator<float> p(out, "x");
  std::printf("seen in C++: %u x %u in %s, first point (%.2f, %.2f, %.2f), its normal (%.2f, %.2f, %.2f), its viewpoint (%g, %g, %g)\n", out.width,
              out.height, out.header.frame_id.c_str(), p[0], p[1], p[2], p[3], p[4], p[5], p[6], p[7], p[8]);
  const bool turned = std::abs(p[0] - 12) < 1e-5 && std::abs(p[2]) < 1e-5;
  return turned && p[3] == 0 && p[5] == -1 && p[6] == 0 && out.width == 4 && out.height == 3 ? 0 : 1;
}
CPP
g++ -w -O1 -std=c++17 -I/usr/include/eigen3 t.cpp -o t -ltf2 -ltf2_ros -lroscpp -lrostime -lrosconsole -lroscpp_serialization -lboost_system \
  >cc.log 2>&1 || { grep -m3 -E 'error|undefined' cc.log; echo "cannot be compiled: not looked at"; exit 2; }
cat >t.py <<'PY'
import struct
import sys

from geometry_msgs.msg import TransformStamped
from sensor_msgs import point_cloud2
from sensor_msgs.msg import PointCloud2, PointField
from tf2_sensor_msgs.tf2_sensor_msgs import do_transform_cloud

names = "x y z normal_x normal_y normal_z vp_x vp_y vp_z".split()
cloud = PointCloud2(height=3, width=4, point_step=36, row_step=144, is_dense=True)
cloud.fields = [PointField(name, 4 * i, PointField.FLOAT32, 1) for i, name in enumerate(names)]
cloud.data = b"".join(struct.pack("<9f", 0.1 * (i % 4), 0.1 * (i // 4), 2, 0, 0, -1, 0, 0, 0) for i in range(12))
pose = TransformStamped()
pose.header.frame_id = "map"
pose.transform.translation.x = 10
pose.transform.rotation.y = pose.transform.rotation.w = 0.5**0.5
out = do_transform_cloud(cloud, pose)
first = next(point_cloud2.read_points(out))
print(f"seen in Python: {out.width} x {out.height} in {out.header.frame_id}, first point {tuple(round(v, 2) for v in first[:3])}, "
      f"its normal {first[3:6]}, its viewpoint {first[6:]}")
turned = abs(first[0] - 12) < 1e-5 and abs(first[2]) < 1e-5
sys.exit(0 if turned and first[3:6] == (0, 0, -1) and first[6:] == (0, 0, 0) and (out.width, out.height) == (12, 1) else 1)
PY
./t && /usr/bin/python3 t.py || { echo "the behaviour has changed"; exit 1; }
echo "as described: x, y and z are turned, nothing else is"
