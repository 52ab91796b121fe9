#!/usr/bin/env bash
# OpenCV's saturating conversions end at two thousand million, and give 0 beyond
#
# One would swear: convertTo and saturate_cast clip: a float that is too large for 16
#   bits becomes 65535, and the larger, the surer; that is what the name says.
# What happens: floats go through a 32-bit integer first, and a processor of the x86
#   kind makes its smallest number of all that does not fit. Up to 2147483520 the
#   result is 65535, above it is 0 (255 and 0 in 8 bits, 32767 and -32768 in signed
#   16). Infinity gives 0. So do convertScaleAbs, multiply with a type, and imwrite
#   of a float picture as PNG, all without a word. Doubles alike.
# What follows: renderers mark the sky by a huge depth: Blender's 1e10 m, times 1000 or
#   5000, is 0, "no reading", where 65535, "far", was meant, while a sky of 1e5 m in the same
#   set is 65535. A film converted from floats can hold both marks, by where the
#   background lies. Clip in float (min with 65535) before converting, and decide by
#   name what infinity is to be; a reader takes both 0 and 65535 for no measurement.
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
[ "$(dpkg --print-architecture)" = amd64 ] || { echo "looked at on amd64 only: not looked at"; exit 2; }
want libopencv-core-dev 4.6.0
want libopencv-imgcodecs-dev 4.6.0
want g++ 4:12
echo "expected: 65535 (255 in 8 bits, 32767 in signed 16) for all depths from 70 m on"
cat >"$tmp/t.cpp" <<'CPP'
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <cmath>
#include <cstdio>
#include <string>

int main(int, char** argv) {
  bool as_described = true;
  for (double metres : {60.0, 70.0, 1e5, 2e6, 3e6, 1e10, static_cast<double>(INFINITY)}) {
    for (int width : {1, 41}) {  // one by one, and by the vector instructions
      const cv::Mat depth(1, width, CV_32F, cv::Scalar(metres)), wide(1, width, CV_64F, cv::Scalar(metres));
      cv::Mat u16, u8, s16, from_double, absolute, product;
      depth.convertTo(u16, CV_16U, 1000);
      depth.convertTo(u8, CV_8U, 1000);
      depth.convertTo(s16, CV_16S, 1000);
      wide.convertTo(from_double, CV_16U, 1000);
      cv::convertScaleAbs(depth, absolute, 1000);
      cv::multiply(depth, cv::Scalar(1000), product, 1, CV_16U);
      const std::string file = std::string(argv[1]) + "/depth.png";
      const bool written = cv::imwrite(file, depth * 1000);
      const int png = cv::imread(file, cv::IMREAD_UNCHANGED).at<uchar>(0);
      const int cast = cv::saturate_cast<ushort>(static_cast<float>(metres * 1000));
      if (width == 41)
        std::printf("seen: %g m x 1000: 16 bits %d, from doubles %d, saturate_cast %d, multiply %d; signed 16 bits %d; "
                    "8 bits %d, convertScaleAbs %d, imwrite as PNG %d (it says %s)\n",
                    metres, u16.at<ushort>(0), from_double.at<ushort>(0), cast, product.at<ushort>(0), s16.at<short>(0),
                    u8.at<uchar>(0), absolute.at<uchar>(0), png, written ? "true" : "false");
      const bool beyond = metres * 1000 >= 2147483648.0;
      const int full = beyond ? 0 : metres < 65 ? 60000 : 65535, full8 = beyond ? 0 : 255;
      for (int i : {0, width - 1})
        as_described = as_described && u16.at<ushort>(i) == full && from_double.at<ushort>(i) == full &&
                       product.at<ushort>(i) == full && s16.at<short>(i) == (beyond ? -32768 : 32767) &&
                       u8.at<uchar>(i) == full8 && absolute.at<uchar>(i) == full8;
      as_described = as_described && cast == full && png == full8 && written;
    }
  }
  const float last = std::nextafter(2147483648.0F, 0.0F);
  cv::Mat below, above;
  cv::Mat(1, 1, CV_32F, cv::Scalar(last)).convertTo(below, CV_16U);
  cv::Mat(1, 1, CV_32F, cv::Scalar(2147483648.0)).convertTo(above, CV_16U);
  std::printf("seen: %.0f gives %d, the next float %d\n", last, below.at<ushort>(0), above.at<ushort>(0));
  as_described = as_described && below.at<ushort>(0) == 65535 && above.at<ushort>(0) == 0;
  return as_described ? 0 : 1;
}
CPP
g++ -w -I/usr/include/opencv4 "$tmp/t.cpp" -o "$tmp/t" -lopencv_core -lopencv_imgcodecs 2>"$tmp/cc.log" ||
  { tail -5 "$tmp/cc.log"; echo "cannot be compiled: not looked at"; exit 2; }
"$tmp/t" "$tmp" || { echo "the behaviour has changed"; exit 1; }
