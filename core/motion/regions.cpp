#include "core/motion/regions.hpp"

#include <opencv2/imgproc.hpp>

namespace stillpoint {

LabelledRegions find_regions(const cv::Mat& mask) {
  LabelledRegions found;
  cv::Mat stats, centroids;
  const int count = cv::connectedComponentsWithStats(mask, found.labels, stats, centroids, 8, CV_32S);
  for (int label = 1; label < count; ++label) {  // 0 is what does not move
    const int* of = stats.ptr<int>(label);
    const double* centre = centroids.ptr<double>(label);
    found.regions.push_back(
        {.box = {of[cv::CC_STAT_LEFT], of[cv::CC_STAT_TOP], of[cv::CC_STAT_WIDTH], of[cv::CC_STAT_HEIGHT]},
         .centroid = {centre[0], centre[1]},
         .area = of[cv::CC_STAT_AREA]});
    found.area += of[cv::CC_STAT_AREA];
  }
  return found;
}

}  // namespace stillpoint
