// Folders as people really have them: each is read as it is meant, or what is wrong is told before the first
// frame.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <functional>

#include "tests/unit/input_folder.hpp"

namespace stillpoint {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;

struct Stamps {
  const char* name;
  InputFolder::Stamp write;
  const char* told;
};
void PrintTo(const Stamps& stamps, std::ostream* to) { *to << stamps.name; }

class StampsOf : public testing::TestWithParam<Stamps> {};

TEST_P(StampsOf, AreReadAlikeInEveryList) {
  const InputFolder folder;
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
  const InputFolder folder;
  folder.lists([](double, int i) { return std::to_string(i); });
  OpenOptions options;
  options.frame_rate = 10;
  const auto source = folder.open(options);
  EXPECT_NEAR(source->timestamp(5), 0.5, 1e-12);
  EXPECT_NEAR(source->read(5).depth_timestamp, 0.5, 1e-12);
  EXPECT_NEAR(source->ground_truth()[5].timestamp, 0.5, 1e-12);
}

TEST(FolderInput, TruthInAnotherUnitThanTheImagesIsConvertedAndTold) {
  const InputFolder folder;
  std::string truth;
  for (int i = 0; i < kInputFrames; ++i)
    truth += fmt::format("{:.0f},{},0,0,0,0,0,1\n", (kStart + i / 30.0) * 1e9, i);
  folder.folder.write("groundtruth.txt", truth);
  const auto source = folder.open();
  expect_whole(*source);
  EXPECT_THAT(source->warnings(), Contains(HasSubstr("groundtruth.txt: the stamps are nanoseconds")));
}

TEST(FolderInput, NumberedImagesWithTruthOfAClockSayThatItMeetsNothing) {
  const InputFolder folder;
  const std::string truth = folder.folder.read("groundtruth.txt");
  folder.lists([](double, int i) { return std::to_string(i); });
  folder.folder.write("groundtruth.txt", truth);
  const auto source = folder.open();
  EXPECT_THAT(source->why_not(FramePart::truth),
              HasSubstr("none of its 12 poses is within 0.02 s of a frame"));
  EXPECT_TRUE(source->read(3).has_depth());
}

TEST(FolderInput, TruthOfFewFramesIsTold) {
  const InputFolder folder;
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
  const InputFolder folder;
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
  const InputFolder folder;
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
  const InputFolder folder;
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
    const InputFolder folder;
    std::string pairs;
    for (int i = 0; i < kInputFrames; ++i)
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
  const InputFolder folder;
  const std::string rgb = folder.folder.read("rgb.txt");
  for (const auto& [cut, told] :
       {std::pair(11U, "the last line was cut short"), std::pair(4U, "cut short in its name"),
        std::pair(20U, "the last line was cut short")}) {
    folder.folder.write("rgb.txt", rgb.substr(0, rgb.size() - cut));
    const auto source = folder.open();
    EXPECT_EQ(source->size(), kInputFrames - 1) << cut;
    EXPECT_THAT(source->warnings(), Contains(HasSubstr(told))) << cut;
  }
}

TEST(FolderInput, StampsWithTooFewDigitsAreRefused) {
  const InputFolder folder;
  folder.lists([](double t, int) { return fmt::format("{:.0f}", t); });
  EXPECT_THAT(input_error_of([&] { (void)folder.open(); }),
              HasSubstr("written with too few digits to tell frames apart"));
}

TEST(FolderInput, ImagesAloneAreASequence) {
  const InputFolder folder;
  for (const char* gone : {"rgb.txt", "depth.txt", "groundtruth.txt"})
    std::filesystem::remove(folder.folder.path(gone));
  const auto source = folder.open();
  ASSERT_EQ(source->size(), kInputFrames);
  for (int i = 0; i < kInputFrames; ++i) {
    EXPECT_NEAR(source->timestamp(i), i / 30.0, 1e-9);
    const Frame frame = source->read(i);
    EXPECT_EQ(frame.colour.at<cv::Vec3b>(5, 5)[2], i) << "10 comes after 9";
    EXPECT_FLOAT_EQ(frame.depth.at<float>(5, 5), static_cast<float>(10000 + i) / 5000.0F);
  }
  EXPECT_THAT(source->warnings(), Contains(HasSubstr("nothing lists its 12 images")));
  const auto colours = open_sequence(folder.folder.path("rgb"));
  EXPECT_EQ(colours->size(), kInputFrames);
  EXPECT_FALSE(colours->has_depth());
  EXPECT_EQ(colours->why_not(FramePart::depth), "");
}

TEST(FolderInput, TruthIsReadInTheConventionThatIsAskedFor) {
  const InputFolder folder;
  folder.folder.write("groundtruth.txt", fmt::format("{:.6f} 1 2 3 0.6 0 0 0.8\n", kStart + 3 / 30.0));
  OpenOptions options;
  options.truth = PoseConvention::mirrored_y;
  const Pose pose = *folder.open(options)->truth(3).world_from_camera;
  EXPECT_LT((pose.translation() - Eigen::Vector3d(1, -2, 3)).norm(), 1e-12);
  EXPECT_LT((pose.linear() - Eigen::Quaterniond(0.8, -0.6, 0, 0).toRotationMatrix()).norm(), 1e-12);
}

TEST(FolderInput, BonnsTruthIsToldToBeAMarkers) {
  const InputFolder folder("rgbd_bonn_test");
  std::filesystem::remove(folder.folder.path("camera.toml"));
  EXPECT_THAT(folder.open()->warnings(), Contains(HasSubstr("`--truth bonn`")));
  OpenOptions options;
  options.truth = PoseConvention::bonn;
  const auto converted = folder.open(options);
  EXPECT_THAT(converted->warnings(), testing::Not(Contains(HasSubstr("marker"))));
}

}  // namespace
}  // namespace stillpoint
