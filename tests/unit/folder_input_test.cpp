// Folders as people really have them: each is read as it is meant, or what is wrong is told before the first
// frame.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <functional>

#include "core/sequence/image_survey.hpp"
#include "core/sequence/source.hpp"
#include "tests/unit/temporary_folder.hpp"

namespace stillpoint {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr int kFrames = 12;
constexpr double kStart = 1305031102.175;  // s since 1970

/// A folder at 30 Hz with depth 4 ms later and ground truth at 100 Hz, whose stamps and names are written as
/// told.
class Folder {
 public:
  explicit Folder(const std::string& name = "rgbd_dataset_freiburg3_test") : folder(name) {
    folder.write("camera.toml",
                 "name = \"own\"\nwidth = 64\nheight = 48\nfx = 60\nfy = 60\ncx = 32\ncy = 24\n");
    for (int i = 0; i < kFrames; ++i) {
      folder.write(fmt::format("rgb/{}.png", i), cv::Mat(48, 64, CV_8UC3, cv::Scalar(10, 20, i)));
      folder.write(fmt::format("depth/{}.png", i), cv::Mat(48, 64, CV_16UC1, cv::Scalar(10000 + i)));
    }
    lists([](double t, int) { return fmt::format("{:.6f}", t); });
  }

  using Stamp = std::function<std::string(double seconds, int frame)>;
  /// The three lists, stamps written by `stamp`.
  void lists(const Stamp& stamp) const {
    std::string rgb, depth, truth;
    for (int i = 0; i < kFrames; ++i) {
      rgb += fmt::format("{} rgb/{}.png\n", stamp(kStart + i / 30.0, i), i);
      depth += fmt::format("{} depth/{}.png\n", stamp(kStart + 0.004 + i / 30.0, i), i);
      truth += fmt::format("{} {} 0 0 0 0 0 1\n", stamp(kStart + i / 30.0, i), i);
    }
    folder.write("rgb.txt", rgb);
    folder.write("depth.txt", depth);
    folder.write("groundtruth.txt", truth);
  }
  [[nodiscard]] std::unique_ptr<FrameSource> open(const OpenOptions& options = {}) const {
    return open_sequence(folder.path(), options);
  }
  void replace(const std::string& file, const std::string& what, const std::string& by) const {
    std::string text = folder.read(file);
    for (auto at = text.find(what); at != std::string::npos; at = text.find(what, at + by.size()))
      text.replace(at, what.size(), by);
    folder.write(file, text);
  }
  void each_depth(const std::function<cv::Mat(const cv::Mat&)>& make, const std::string& kind = "png") const {
    for (int i = 0; i < kFrames; ++i) {
      const cv::Mat depth(48, 64, CV_16UC1, cv::Scalar(10000 + i));
      folder.write(fmt::format("depth/{}.{}", i, kind), make(depth));
    }
    replace("depth.txt", ".png", "." + kind);
  }

  TemporaryFolder folder;
};

/// Every frame has its depth and its truth, 1/30 s apart, and the right ones.
void expect_whole(const FrameSource& source) {
  ASSERT_EQ(source.size(), kFrames);
  EXPECT_TRUE(source.has_depth());
  for (int i = 0; i < kFrames; ++i) {
    const Frame frame = source.read(i);
    EXPECT_EQ(frame.problem, "") << i;
    ASSERT_TRUE(frame.has_depth()) << i;
    EXPECT_EQ(frame.colour.at<cv::Vec3b>(5, 5)[2], i);
    EXPECT_FLOAT_EQ(frame.depth.at<float>(5, 5), static_cast<float>(10000 + i) / 5000.0F);
    EXPECT_LT(std::abs(frame.depth_timestamp - frame.timestamp), 0.005) << i;
    ASSERT_TRUE(source.truth(i).world_from_camera) << i;
    EXPECT_NEAR(source.truth(i).world_from_camera->translation().x(), i, 1e-3);
    EXPECT_NEAR(source.timestamp(i) - source.timestamp(0), i / 30.0, 1e-5);
  }
}

struct Stamps {
  const char* name;
  Folder::Stamp write;
  const char* told;
};
void PrintTo(const Stamps& stamps, std::ostream* to) { *to << stamps.name; }

class StampsOf : public testing::TestWithParam<Stamps> {};

TEST_P(StampsOf, AreReadAlikeInEveryList) {
  const Folder folder;
  folder.lists(GetParam().write);
  const auto source = folder.open();
  expect_whole(*source);
  if (GetParam().told[0] != '\0') {
    EXPECT_THAT(source->warnings(), Contains(HasSubstr(GetParam().told)));
  }
}

INSTANTIATE_TEST_SUITE_P(
    FolderInput, StampsOf,
    testing::Values(
        Stamps{"Seconds", [](double seconds, int) { return fmt::format("{:.6f}", seconds); }, ""},
        Stamps{"Milliseconds", [](double seconds, int) { return fmt::format("{:.3f}", seconds * 1e3); },
               "are milliseconds"},
        Stamps{"Microseconds", [](double seconds, int) { return fmt::format("{:.0f}", seconds * 1e6); },
               "are microseconds"},
        Stamps{"Nanoseconds", [](double seconds, int) { return fmt::format("{:.0f}", seconds * 1e9); },
               "are nanoseconds"},
        Stamps{"NanosecondsFromZero",
               [](double seconds, int) { return fmt::format("{:.0f}", (seconds - kStart) * 1e9); },
               "are nanoseconds"},
        Stamps{"FrameNumbers", [](double, int i) { return std::to_string(i); }, "frames at 30 Hz"},
        Stamps{"PaddedFrameNumbers", [](double, int i) { return fmt::format("{:06d}", i + 1); },
               "frames at 30 Hz"}),
    [](const auto& tested) { return std::string(tested.param.name); });

TEST(FolderInput, FrameNumbersHaveTheRateThatIsSaid) {
  const Folder folder;
  folder.lists([](double, int i) { return std::to_string(i); });
  OpenOptions options;
  options.frame_rate = 10;
  const auto source = folder.open(options);
  EXPECT_NEAR(source->timestamp(5), 0.5, 1e-12);
  EXPECT_NEAR(source->read(5).depth_timestamp, 0.5, 1e-12);
  EXPECT_NEAR(source->ground_truth()[5].timestamp, 0.5, 1e-12);
}

TEST(FolderInput, TruthInAnotherUnitThanTheImagesIsConvertedAndTold) {
  const Folder folder;
  std::string truth;
  for (int i = 0; i < kFrames; ++i)
    truth += fmt::format("{:.0f},{},0,0,0,0,0,1\n", (kStart + i / 30.0) * 1e9, i);
  folder.folder.write("groundtruth.txt", truth);
  const auto source = folder.open();
  expect_whole(*source);
  EXPECT_THAT(source->warnings(), Contains(HasSubstr("groundtruth.txt: the stamps are nanoseconds")));
}

TEST(FolderInput, NumberedImagesWithTruthOfAClockSayThatItMeetsNothing) {
  const Folder folder;
  const std::string truth = folder.folder.read("groundtruth.txt");
  folder.lists([](double, int i) { return std::to_string(i); });
  folder.folder.write("groundtruth.txt", truth);
  const auto source = folder.open();
  EXPECT_THAT(source->why_not(FramePart::truth),
              HasSubstr("none of its 12 poses is within 0.02 s of a frame"));
  EXPECT_TRUE(source->read(3).has_depth());
}

TEST(FolderInput, TruthOfFewFramesIsTold) {
  const Folder folder;
  folder.folder.write("groundtruth.txt", fmt::format("{:.6f} 3 0 0 0 0 0 1\n", kStart + 3 / 30.0));
  EXPECT_THAT(folder.open()->warnings(), Contains(HasSubstr("has poses for 1 of the 12 frames")));
}

struct Names {
  const char* name;
  const char *by, *told;  ///< written in place of `rgb/` and `depth/`; {} is the folder
};
void PrintTo(const Names& names, std::ostream* to) { *to << names.name; }
class NamesOf : public testing::TestWithParam<Names> {};

TEST_P(NamesOf, AreFoundWhereTheImagesLie) {
  const Folder folder;
  for (const std::string part : {"rgb", "depth"})
    folder.replace(part + ".txt", part + "/", fmt::format(fmt::runtime(GetParam().by), part));
  const auto source = folder.open();
  expect_whole(*source);
  EXPECT_THAT(source->warnings(),
              Contains(AllOf(HasSubstr("rgb.txt:1: there is no"), HasSubstr(GetParam().told))));
}

INSTANTIATE_TEST_SUITE_P(FolderInput, NamesOf,
                         testing::Values(Names{"Bare", "", "but rgb/0.png"},
                                         Names{"Backslashes", "{}\\", "but rgb/0.png"},
                                         Names{"OfAnotherMachine", "/home/someone/data/{}/", "but rgb/0.png"},
                                         Names{"OfAnotherDrive", "D:\\data\\{}\\", "but rgb/0.png"}),
                         [](const auto& tested) { return std::string(tested.param.name); });

TEST(FolderInput, ListsWithSeparatorsAndHeadersOfTablesAreRead) {
  const Folder folder;
  for (const char* list : {"rgb.txt", "depth.txt"}) {
    folder.replace(list, " ", ",");
    folder.folder.write(list, "timestamp,filename\r\n" + folder.folder.read(list));
  }
  const auto source = folder.open();
  expect_whole(*source);
  EXPECT_THAT(source->warnings(), IsEmpty());
  folder.replace("rgb.txt", ",", ";");
  expect_whole(*folder.open());
}

TEST(FolderInput, ListsByOtherNamesAreRead) {
  const Folder folder;
  namespace fs = std::filesystem;
  fs::rename(folder.folder.path("rgb.txt"), folder.folder.path("color.txt"));
  fs::rename(folder.folder.path("depth.txt"), folder.folder.path("aligned_depth.txt"));
  const auto source = folder.open();
  expect_whole(*source);
  EXPECT_THAT(source->warnings(),
              testing::IsSupersetOf({HasSubstr("color.txt: is read in place of rgb.txt"),
                                     HasSubstr("aligned_depth.txt: is read in place of depth.txt")}));
}

TEST(FolderInput, AssociationsByOtherNamesAreRead) {
  for (const char* name : {"associate.txt", "association.txt", "assoc.txt"}) {
    const Folder folder;
    std::string pairs;
    for (int i = 0; i < kFrames; ++i)
      pairs += fmt::format("{0:.6f} rgb/{2}.png {1:.6f} depth/{2}.png\n", kStart + i / 30.0,
                           kStart + 0.004 + i / 30.0, i);
    folder.folder.write(name, pairs);
    for (const char* gone : {"rgb.txt", "depth.txt"}) std::filesystem::remove(folder.folder.path(gone));
    const auto source = folder.open();
    expect_whole(*source);
    EXPECT_THAT(source->warnings(), Contains(HasSubstr("is read in place of associations.txt")));
  }
}

TEST(FolderInput, AListCutShortLosesItsLastRow) {
  const Folder folder;
  const std::string rgb = folder.folder.read("rgb.txt");
  for (const auto& [cut, told] :
       {std::pair(11U, "the last line was cut short"), std::pair(4U, "cut short in its name"),
        std::pair(20U, "the last line was cut short")}) {
    folder.folder.write("rgb.txt", rgb.substr(0, rgb.size() - cut));
    const auto source = folder.open();
    EXPECT_EQ(source->size(), kFrames - 1) << cut;
    EXPECT_THAT(source->warnings(), Contains(HasSubstr(told))) << cut;
  }
}

TEST(FolderInput, StampsWithTooFewDigitsAreRefused) {
  const Folder folder;
  folder.lists([](double t, int) { return fmt::format("{:.0f}", t); });
  EXPECT_THAT(input_error_of([&] { (void)folder.open(); }),
              HasSubstr("written with too few digits to tell frames apart"));
}

TEST(FolderInput, ImagesAloneAreASequence) {
  const Folder folder;
  for (const char* gone : {"rgb.txt", "depth.txt", "groundtruth.txt"})
    std::filesystem::remove(folder.folder.path(gone));
  const auto source = folder.open();
  ASSERT_EQ(source->size(), kFrames);
  for (int i = 0; i < kFrames; ++i) {
    EXPECT_NEAR(source->timestamp(i), i / 30.0, 1e-9);
    const Frame frame = source->read(i);
    EXPECT_EQ(frame.colour.at<cv::Vec3b>(5, 5)[2], i) << "10 comes after 9";
    EXPECT_FLOAT_EQ(frame.depth.at<float>(5, 5), static_cast<float>(10000 + i) / 5000.0F);
  }
  EXPECT_THAT(source->warnings(), Contains(HasSubstr("nothing lists its 12 images")));
  const auto colours = open_sequence(folder.folder.path("rgb"));
  EXPECT_EQ(colours->size(), kFrames);
  EXPECT_FALSE(colours->has_depth());
  EXPECT_EQ(colours->why_not(FramePart::depth), "");
}

TEST(FolderInput, DepthOfAnotherKindIsKnownBeforeTheFirstFrame) {
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
  for (const Kind& kind : {Kind{as(CV_8UC1), "png", "holds 1 channel(s) of 8 bits, expected depth"},
                           Kind{as(CV_8UC3), "png", "holds 3 channel(s) of 8 bits, expected depth"},
                           Kind{as(CV_32FC1), "tiff", "1 channel(s) of 32 bits (floating point)"},
                           Kind{half, "png", "is 32x24 px, but its colour image is 64x48 px"}}) {
    const Folder folder;
    folder.each_depth(kind.make, kind.file);
    const auto source = folder.open();
    EXPECT_FALSE(source->has_depth()) << kind.told;
    EXPECT_THAT(source->why_not(FramePart::depth), HasSubstr(kind.told));
    EXPECT_TRUE(source->read(0).readable());
  }
  const Folder folder;
  for (int i = 0; i < kFrames; ++i)
    folder.folder.write(fmt::format("depth/{}.npy", i), std::string("\x93NUMPY\x01 …"));
  folder.replace("depth.txt", ".png", ".npy");
  EXPECT_THAT(folder.open()->why_not(FramePart::depth), HasSubstr("depth/0.npy is a NumPy array"));
}

TEST(FolderInput, OneDepthImageOfAnotherKindCostsItsFrameAlone) {
  const Folder folder;
  folder.folder.write("depth/0.png", cv::Mat(48, 64, CV_8UC1, cv::Scalar(9)));
  const auto source = folder.open();
  EXPECT_TRUE(source->has_depth());
  EXPECT_FALSE(source->read(0).has_depth());
  EXPECT_TRUE(source->read(1).has_depth());
}

TEST(FolderInput, TheLargestDepthIsNoMeasurement) {
  const Folder folder;
  folder.each_depth([](const cv::Mat& depth) {
    cv::Mat made = depth.clone();
    made(cv::Rect(0, 0, 32, 48)) = 65535;
    return made;
  });
  const Frame frame = folder.open()->read(2);
  EXPECT_EQ(frame.depth.at<float>(5, 5), 0.0F);
  EXPECT_FLOAT_EQ(frame.depth.at<float>(5, 40), 10002 / 5000.0F);
}

TEST(FolderInput, DepthOfAnotherClockNamesTheOffset) {
  const Folder folder;
  std::string depth;
  for (int i = 0; i < kFrames; ++i)
    depth += fmt::format("{:.6f} depth/{}.png\n", kStart + 1000.004 + i / 30.0, i);
  folder.folder.write("depth.txt", depth);
  auto source = folder.open();
  EXPECT_FALSE(source->has_depth());
  EXPECT_THAT(source->why_not(FramePart::depth), HasSubstr("`--depth-offset -1000.004000`"));
  OpenOptions options;
  options.depth_offset_s = -1000;
  expect_whole(*folder.open(options));
}

TEST(FolderInput, MillimetresReadAsSomethingElseAreQuestioned) {
  const Folder folder;
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

TEST(FolderInput, ScalesAreDoubtedByTheRangeTheyGive) {
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
std::unique_ptr<FrameSource> with_masks(const Folder& folder,
                                        const std::function<cv::Mat(const cv::Mat&)>& make,
                                        const OpenOptions& options = {}) {
  std::string list;
  for (int i = 0; i < kFrames; ++i) {
    cv::Mat mask = cv::Mat::zeros(48, 64, CV_8UC1);
    mask(cv::Rect(10, 10, 16, 20)) = 255;
    folder.folder.write(fmt::format("mask/{}.png", i), make(mask));
    list += fmt::format("{:.6f} mask/{}.png\n", kStart + i / 30.0, i);
  }
  folder.folder.write("mask.txt", list);
  return folder.open(options);
}

TEST(FolderInput, MasksAreReadInEveryCoding) {
  const Folder folder;
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

TEST(FolderInput, MasksThatLookInvertedOrAreOfAnotherSizeAreTold) {
  const Folder folder;
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

TEST(FolderInput, TruthIsReadInTheConventionThatIsAskedFor) {
  const Folder folder;
  folder.folder.write("groundtruth.txt", fmt::format("{:.6f} 1 2 3 0.6 0 0 0.8\n", kStart + 3 / 30.0));
  OpenOptions options;
  options.truth = PoseConvention::mirrored_y;
  const Pose pose = *folder.open(options)->truth(3).world_from_camera;
  EXPECT_LT((pose.translation() - Eigen::Vector3d(1, -2, 3)).norm(), 1e-12);
  EXPECT_LT((pose.linear() - Eigen::Quaterniond(0.8, -0.6, 0, 0).toRotationMatrix()).norm(), 1e-12);
}

TEST(FolderInput, BonnsTruthIsToldToBeAMarkers) {
  const Folder folder("rgbd_bonn_test");
  std::filesystem::remove(folder.folder.path("camera.toml"));
  EXPECT_THAT(folder.open()->warnings(), Contains(HasSubstr("`--truth bonn`")));
  OpenOptions options;
  options.truth = PoseConvention::bonn;
  const auto converted = folder.open(options);
  EXPECT_THAT(converted->warnings(), testing::Not(Contains(HasSubstr("marker"))));
}

}  // namespace
}  // namespace stillpoint
