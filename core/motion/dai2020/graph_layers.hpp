#pragma once

#include <opencv2/core.hpp>
#include <span>
#include <string>
#include <vector>

#include "core/motion/dai2020/point_graph.hpp"
#include "core/motion/stage_log.hpp"

namespace stillpoint {

// Pictures of a graph, for the stages of methods that have one.

/// CV_32FC1 with a value along each edge, NaN elsewhere. Edges without a finite value are left out; the
/// largest lie on top.
[[nodiscard]] cv::Mat edge_image(const cv::Size& size, std::span<const GraphPoint> points,
                                 std::span<const PointPair> edges, std::span<const float> values);

/// CV_32FC1 with a value about each point, NaN elsewhere.
[[nodiscard]] cv::Mat point_image(const cv::Size& size, std::span<const GraphPoint> points,
                                  std::span<const float> values);

/// How a verdict is marked: static as inlier, dynamic as removed, undecided as outlier, unjudged as
/// unmatched.
[[nodiscard]] MarkKind mark_of(PointVerdict verdict);
/// What these marks stand for: Layer::words.
[[nodiscard]] std::map<MarkKind, std::string> verdict_words();

/// The features over the frame, each by its verdict.
[[nodiscard]] Layer feature_verdicts(const Layer& frame, std::span<const MotionFeature> features,
                                     std::span<const PointVerdict> verdicts);

/// What is held of a feature that takes after a point: that of the point, or unjudged.
[[nodiscard]] std::vector<PointVerdict> verdicts_of(std::span<const int> nearest,
                                                    std::span<const PointVerdict> of_point);

/// The feature within 4 px of a pixel, the nearest; -1 where there is none.
[[nodiscard]] int feature_near(std::span<const MotionFeature> features, const cv::Point2f& pixel);

[[nodiscard]] std::string sentence_of(PointVerdict verdict);

}  // namespace stillpoint
