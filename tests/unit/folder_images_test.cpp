// Depth and masks as people really have them: read as they are meant, or told before the first frame.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

#include "core/sequence/image_survey.hpp"
#include "tests/unit/input_folder.hpp"

namespace stillpoint {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;

TEST(FolderImages, DepthOfAnotherKindIsKnownBeforeTheFirstFrame) {
  struct Kind {
    std::function<cv::Mat(const cv::Mat&)> make;
    const char *file, *told;
  };
  const auto as = [](int type) {
    return [type](const cv::Mat& depth) {
      cv::Mat made;
      depth.convertTo(made, CV_MAT_DEPTH(type), CV_MAT_DEPTH(type) == CV_8U ? 1 / 257.0 : 1 / 5000.0);
      if (CV_MAT_CN(type) == 3) cv::merge(std::vector<cv::Mat>(3, made), made);
      return made;
    };
  };
  const auto half = [](const cv::Mat& depth) { return depth(cv::Rect(0, 0, 32, 24)).clone(); };
  for (const Kind& kind : {Kind{as(CV_8UC1), "png", "holds 1 channel of 8 bits, expected depth"},
                           Kind{as(CV_8UC3), "png", "holds 3 channels of 8 bits, expected depth"},
                           Kind{as(CV_32FC1), "tiff", "1 channel of 32 bits (floating point)"},
                           Kind{half, "png", "is 32x24 px, but its colour image is 64x48 px"}}) {
    const InputFolder folder;
    folder.each_depth(kind.make, kind.file);
    const auto source = folder.open();
    EXPECT_FALSE(source->has_depth()) << kind.told;
    EXPECT_THAT(source->why_not(FramePart::depth), HasSubstr(kind.told));
    EXPECT_TRUE(source->read(0).readable());
  }
  const InputFolder folder;
  for (int i = 0; i < kInputFrames; ++i)
    folder.folder.write(fmt::format("depth/{}.npy", i), std::string("\x93NUMPY\x01 …"));
  folder.replace("depth.txt", ".png", ".npy");
  EXPECT_THAT(folder.open()->why_not(FramePart::depth), HasSubstr("depth/0.npy is a NumPy array"));
}

TEST(FolderImages, OneDepthImageOfAnotherKindCostsItsFrameAlone) {
  const InputFolder folder;
  folder.folder.write("depth/0.png", cv::Mat(48, 64, CV_8UC1, cv::Scalar(9)));
  const auto source = folder.open();
  EXPECT_TRUE(source->has_depth());
  EXPECT_FALSE(source->read(0).has_depth());
  EXPECT_TRUE(source->read(1).has_depth());
}

TEST(FolderImages, TheLargestDepthIsNoMeasurement) {
  const InputFolder folder;
  folder.each_depth([](const cv::Mat& depth) {
    cv::Mat made = depth.clone();
    made(cv::Rect(0, 0, 32, 48)) = 65535;
    return made;
  });
  const Frame frame = folder.open()->read(2);
  EXPECT_EQ(frame.depth.at<float>(5, 5), 0.0F);
  EXPECT_FLOAT_EQ(frame.depth.at<float>(5, 40), 10002 / 5000.0F);
}

TEST(FolderImages, DepthOfAnotherClockNamesTheOffset) {
  const InputFolder folder;
  std::string depth;
  for (int i = 0; i < kInputFrames; ++i)
    depth += fmt::format("{:.6f} depth/{}.png\n", kStart + 1000.004 + i / 30.0, i);
  folder.folder.write("depth.txt", depth);
  auto source = folder.open();
  EXPECT_FALSE(source->has_depth());
  EXPECT_THAT(source->why_not(FramePart::depth), HasSubstr("`--depth-offset -1000.004000`"));
  OpenOptions options;
  options.depth_offset_s = -1000;
  expect_whole(*folder.open(options));
}

TEST(FolderImages, MillimetresReadAsSomethingElseAreQuestioned) {
  const InputFolder folder;
  folder.each_depth([](const cv::Mat& depth) {
    cv::Mat made = depth / 8;  // 1.25 m in mm
    made(cv::Rect(0, 0, 20, 48)) = 900;
    return made;
  });
  auto source = folder.open();
  EXPECT_THAT(source->warnings(),
              Contains(AllOf(HasSubstr("at 5000 units a metre"), HasSubstr("`--depth-scale 1000`"))));
  OpenOptions options;
  options.depth_scale = 1000;
  source = folder.open(options);
  EXPECT_THAT(source->warnings(), IsEmpty());
  EXPECT_FLOAT_EQ(source->read(0).depth.at<float>(5, 40), 1.25F);
}

TEST(FolderImages, ScalesAreDoubtedByTheRangeTheyGive) {
  DepthSurvey survey;
  survey.nearest = 4500, survey.median = 6000, survey.farthest = 16000;
  EXPECT_FALSE(doubt_scale(survey, 5000));
  survey.nearest = 600, survey.median = 900, survey.farthest = 2900;
  EXPECT_EQ(doubt_scale(survey, 5000)->likely_scale, 1000);
  EXPECT_FALSE(doubt_scale(survey, 1000));
  survey.nearest = 9000, survey.median = 20000, survey.farthest = 50000;
  EXPECT_EQ(doubt_scale(survey, 1000)->likely_scale, 5000);
  EXPECT_FALSE(doubt_scale({}, 5000));
}

/// A folder whose masks say that a box of a tenth of the image moves, written by `make` from 0/255.
std::unique_ptr<FrameSource> with_masks(const InputFolder& folder,
                                        const std::function<cv::Mat(const cv::Mat&)>& make,
                                        const OpenOptions& options = {}) {
  std::string list;
  for (int i = 0; i < kInputFrames; ++i) {
    cv::Mat mask = cv::Mat::zeros(48, 64, CV_8UC1);
    mask(cv::Rect(10, 10, 16, 20)) = 255;
    folder.folder.write(fmt::format("mask/{}.png", i), make(mask));
    list += fmt::format("{:.6f} mask/{}.png\n", kStart + i / 30.0, i);
  }
  folder.folder.write("mask.txt", list);
  return folder.open(options);
}

TEST(FolderImages, MasksAreReadInEveryCoding) {
  const InputFolder folder;
  const auto moving = [](const FrameSource& source) { return cv::countNonZero(source.truth(3).moving); };
  EXPECT_EQ(moving(*with_masks(folder, [](const cv::Mat& m) { return m; })), 320);
  EXPECT_THAT(folder.open()->warnings(), IsEmpty());
  const auto zero_one = with_masks(folder, [](const cv::Mat& m) { return cv::Mat(m / 255); });
  EXPECT_EQ(moving(*zero_one), 320);
  EXPECT_THAT(zero_one->warnings(), Contains(HasSubstr("the masks hold 0 and 1")));
  const auto wide = [](double factor) {
    return [factor](const cv::Mat& m) {
      cv::Mat made;
      m.convertTo(made, CV_16U, factor);
      return made;
    };
  };
  EXPECT_EQ(moving(*with_masks(folder, wide(1 / 255.0))), 320) << "0 and 1 in 16 bits";
  EXPECT_EQ(moving(*with_masks(folder, wide(257))), 320) << "0 and 65535";
  const auto labels = with_masks(folder, [](const cv::Mat& m) {
    cv::Mat made = m / 255 * 7;
    made(cv::Rect(10, 10, 4, 20)) = 12;
    return made;
  });
  EXPECT_EQ(moving(*labels), 320);
  EXPECT_THAT(labels->warnings(), Contains(HasSubstr("the masks hold 2 labels")));
  const auto red = with_masks(folder, [](const cv::Mat& m) {
    cv::Mat made = cv::Mat::zeros(48, 64, CV_8UC3);
    made.setTo(cv::Scalar(0, 0, 100), m);
    return made;
  });
  EXPECT_EQ(moving(*red), 320) << "a colour for a thing";
}

TEST(FolderImages, MasksThatLookInvertedOrAreOfAnotherSizeAreTold) {
  const InputFolder folder;
  const auto inverted = [](const cv::Mat& m) { return cv::Mat(255 - m); };
  EXPECT_THAT(with_masks(folder, inverted)->warnings(),
              Contains(HasSubstr("90 % of the masks' pixels are said to move")));
  OpenOptions options;
  options.inverted_masks = true;
  const auto mended = with_masks(folder, inverted, options);
  EXPECT_EQ(cv::countNonZero(mended->truth(3).moving), 320);
  EXPECT_THAT(mended->warnings(), IsEmpty());
  const auto small = with_masks(folder, [](const cv::Mat& m) { return m(cv::Rect(0, 0, 32, 24)).clone(); });
  EXPECT_FALSE(small->has_masks());
  EXPECT_THAT(small->why_not(FramePart::masks),
              HasSubstr("the masks are 32x24 px, but the colour images are 64x48 px"));
  EXPECT_TRUE(small->truth(3).moving.empty());
}

}  // namespace
}  // namespace stillpoint
