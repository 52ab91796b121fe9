#include "core/motion/regions.hpp"

#include <algorithm>
#include <climits>
#include <cstdint>
#include <opencv2/imgproc.hpp>

namespace stillpoint {

LabelledRegions find_regions(const cv::Mat& mask) {
  LabelledRegions found;
  const cv::Rect around = cv::boundingRect(mask);
  found.labels = cv::Mat::zeros(mask.size(), CV_32SC1);
  if (around.empty()) return found;
  cv::Mat labels = found.labels(around);
  const int count = cv::connectedComponents(mask(around), labels, 8, CV_32S);
  // OpenCV's own statistics also go through everything that does not move, at seven times the labelling's
  // cost.
  struct Sums {
    int left = INT_MAX, top = INT_MAX, right = -1, bottom = -1, area = 0;
    std::int64_t x = 0, y = 0;
  };
  std::vector<Sums> sums(static_cast<std::size_t>(count));
  for (int y = around.y; y < around.br().y; ++y) {
    const unsigned char* moving = mask.ptr(y);
    const int* label = found.labels.ptr<int>(y);
    for (int x = around.x; x < around.br().x; ++x) {
      if (moving[x] == 0) continue;
      Sums& sum = sums[static_cast<std::size_t>(label[x])];
      sum.left = std::min(sum.left, x);
      sum.right = std::max(sum.right, x);
      sum.top = std::min(sum.top, y);
      sum.bottom = y;
      sum.x += x;
      sum.y += y;
      ++sum.area;
    }
  }
  for (auto sum = sums.begin() + 1; sum != sums.end(); ++sum) {  // label 0 is what does not move
    const double area = sum->area;
    found.regions.push_back(
        {.box = {sum->left, sum->top, sum->right - sum->left + 1, sum->bottom - sum->top + 1},
         .centroid = {static_cast<double>(sum->x) / area, static_cast<double>(sum->y) / area},
         .area = sum->area});
    found.area += sum->area;
  }
  return found;
}

}  // namespace stillpoint
