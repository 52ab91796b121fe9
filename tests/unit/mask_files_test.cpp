// Masks made elsewhere: which file belongs to which frame, and what its values say.
#include "core/sequence/mask_files.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "core/config.hpp"
#include "core/motion/masks/outside_masks.hpp"
#include "core/run/method_needs.hpp"
#include "core/sequence/source.hpp"
#include "tests/unit/temporary_folder.hpp"

namespace stillpoint {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr int kWidth = 16, kHeight = 8;

/// A mask whose column `x` is set: what tells one from another.
cv::Mat column(int x, int value = 255) {
  cv::Mat mask(kHeight, kWidth, CV_8UC1, cv::Scalar(0));
  mask.col(x).setTo(value);
  return mask;
}

/// The columns that are set.
std::vector<int> columns(const cv::Mat& mask) {
  std::vector<int> set;
  for (int x = 0; x < mask.cols; ++x)
    if (cv::countNonZero(mask.col(x)) == mask.rows) set.push_back(x);
  return set;
}

Frame frame(int index, const std::string& name = "", double timestamp = 0.0) {
  Frame made;
  made.index = index;
  made.name = name;
  made.timestamp = timestamp;
  made.gray = cv::Mat(kHeight, kWidth, CV_8UC1, cv::Scalar(90));
  return made;
}

std::vector<int> columns_for(const TemporaryFolder& folder, const Frame& of,
                             const MaskReading& reading = {}) {
  return columns(MaskFiles(folder.path(), reading).read(of).mask);
}

TEST(MaskFiles, BelongToTheFrameWhoseColourImageHasTheirName) {
  const TemporaryFolder folder;
  folder.write("kitchen.png", column(1));
  folder.write("hall.png", column(2));
  EXPECT_THAT(columns_for(folder, frame(0, "hall")), ElementsAre(2));
  EXPECT_THAT(columns_for(folder, frame(1, "kitchen")), ElementsAre(1));
  const FoundMask none = MaskFiles(folder.path(), {}).read(frame(2, "stairs"));
  EXPECT_TRUE(none.mask.empty());
  EXPECT_THAT(none.problem, HasSubstr("has no mask for this frame"));
}

TEST(MaskFiles, MayHaveMoreAroundTheName) {
  const TemporaryFolder folder;
  folder.write("seg_1305031102.175304_mask.png", column(1));
  folder.write("seg_1305031102.211214_mask.png", column(2));
  // The stamp says another frame: the name is the nearer sign.
  EXPECT_THAT(columns_for(folder, frame(0, "1305031102.211214", 1305031102.175304)), ElementsAre(2));
}

TEST(MaskFiles, BelongToTheNearestStamp) {
  const TemporaryFolder folder;
  folder.write("1305031102.175304.png", column(1));
  folder.write("1305031102.211214.png", column(2));
  EXPECT_THAT(columns_for(folder, frame(7, "a", 1305031102.16)), ElementsAre(1));
  EXPECT_THAT(columns_for(folder, frame(7, "b", 1305031102.213)), ElementsAre(2));
  EXPECT_THAT(columns_for(folder, frame(7, "c", 1305031102.3)), IsEmpty());
  EXPECT_THAT(columns_for(folder, frame(7, "d", 1305031102.1)), IsEmpty());
}

TEST(MaskFiles, StampsInNanoseconds) {
  const TemporaryFolder folder;
  folder.write("1403636579763555584.png", column(1));
  folder.write("1403636579813555456.png", column(2));
  EXPECT_THAT(columns_for(folder, frame(0, "x", 1403636579.8135555)), ElementsAre(2));
}

TEST(MaskFiles, BelongToTheFrameOfTheirNumber) {
  const TemporaryFolder folder;
  for (int i = 0; i < 4; ++i) folder.write("mask_00" + std::to_string(i) + ".png", column(i));
  EXPECT_THAT(columns_for(folder, frame(0)), ElementsAre(0));
  EXPECT_THAT(columns_for(folder, frame(3, "1305031102.175304")), ElementsAre(3));
  EXPECT_THAT(columns_for(folder, frame(4)), IsEmpty());
  EXPECT_THAT(MaskFiles(folder.path(), {}).warnings(), IsEmpty());
}

TEST(MaskFiles, NumbersFromOneAreTold) {
  const TemporaryFolder folder;
  for (int i = 1; i < 4; ++i) folder.write(std::to_string(i) + ".png", column(i));
  EXPECT_THAT(columns_for(folder, frame(0)), ElementsAre(1));
  EXPECT_THAT(MaskFiles(folder.path(), {}).warnings(), ElementsAre(HasSubstr("numbered from 1")));
  MaskReading from_zero;
  from_zero.first_number = 0;
  EXPECT_THAT(columns_for(folder, frame(1), from_zero), ElementsAre(1));
  EXPECT_THAT(MaskFiles(folder.path(), from_zero).warnings(), IsEmpty());
  // A colour image that is a number itself leaves nothing to guess.
  EXPECT_THAT(columns_for(folder, frame(0, "0002")), ElementsAre(2));
}

TEST(MaskFiles, OfSeveralInstancesAreUnited) {
  const TemporaryFolder folder;
  for (const char* name : {"000_0", "000_1", "001_0", "002_0", "002_3"})
    folder.write(std::string(name) + ".png", column(2 * (name[2] - '0') + (name[4] == '0' ? 0 : 1)));
  EXPECT_THAT(columns_for(folder, frame(0)), ElementsAre(0, 1));
  EXPECT_THAT(columns_for(folder, frame(1)), ElementsAre(2));
  EXPECT_THAT(columns_for(folder, frame(2)), ElementsAre(4, 5));
  EXPECT_THAT(MaskFiles(folder.path(), {}).warnings(),
              ElementsAre(HasSubstr("5 images are named by 3 numbers; those of one number are united")));
}

TEST(MaskFiles, OfAList) {
  const TemporaryFolder folder;
  folder.write("seg/a.png", column(1));
  folder.write("seg/b.png", column(2));
  folder.write("mask.txt", "# stamp file\n100.0 seg/a.png\n100.033 seg/b.png\n");
  const MaskFiles listed(folder.path("mask.txt"), {});
  EXPECT_THAT(columns(listed.read(frame(5, "x", 100.034)).mask), ElementsAre(2));
  // The folder stands for the list it holds.
  EXPECT_THAT(columns_for(folder, frame(5, "x", 100.001)), ElementsAre(1));
}

TEST(MaskFiles, ZeroAndOneAndLabels) {
  const TemporaryFolder folder;
  folder.write("0.png", column(1, 1));
  EXPECT_THAT(columns_for(folder, frame(0)), ElementsAre(1));
  folder.write("0.png", column(1, 15) + column(4, 7) + column(6, 2));
  EXPECT_THAT(columns_for(folder, frame(0)), ElementsAre(1, 4, 6));
  MaskReading people;
  people.labels = {"15", "2"};
  EXPECT_THAT(columns_for(folder, frame(0), people), ElementsAre(1, 6));
  people.inverted = true;
  EXPECT_EQ(columns_for(folder, frame(0), people).size(), kWidth - 2U);
}

TEST(MaskFiles, LabelsAsColours) {
  const TemporaryFolder folder;
  cv::Mat palette(kHeight, kWidth, CV_8UC3, cv::Scalar(0, 0, 0));
  palette.col(3).setTo(cv::Scalar(0x80, 0x00, 0xC0));  // BGR
  palette.col(5).setTo(cv::Scalar(0x00, 0x80, 0xC0));
  folder.write("0.png", palette);
  MaskReading reading;
  reading.labels = {"#c00080"};
  EXPECT_THAT(columns_for(folder, frame(0), reading), ElementsAre(3));
  reading.labels = {"15"};
  const FoundMask refused = MaskFiles(folder.path(), reading).read(frame(0));
  EXPECT_TRUE(refused.mask.empty());
  EXPECT_THAT(refused.problem, HasSubstr("is a coloured image, and a label is given as a number"));
  reading.labels = {"person"};
  EXPECT_THAT(input_error_of([&] { MaskFiles(folder.path(), reading); }), HasSubstr("'person' is no label"));
}

TEST(MaskFiles, ColouredThingsOnBlackAreTakenOut) {
  // Networks draw people red or in a palette's colours, of which grey levels make less than half.
  for (const cv::Scalar& colour : {cv::Scalar(0, 0, 255), cv::Scalar(128, 0, 192), cv::Scalar(255, 0, 0)}) {
    const TemporaryFolder folder;
    cv::Mat drawn(kHeight, kWidth, CV_8UC3, cv::Scalar(0, 0, 0));
    drawn.col(3).setTo(colour);
    folder.write("0.png", drawn);
    EXPECT_THAT(columns_for(folder, frame(0)), ElementsAre(3)) << colour;
    EXPECT_THAT(MaskFiles(folder.path(), {}).warnings(),
                ElementsAre(HasSubstr("the masks are coloured; what is bright in one of its colours is taken "
                                      "out (masks.labels chooses)")));
  }
}

TEST(MaskFiles, WhatIsCutOutByAlphaIsTakenOut) {
  const TemporaryFolder folder;
  cv::Mat cut(kHeight, kWidth, CV_8UC4, cv::Scalar(0, 0, 0, 0));
  cut.col(5).setTo(cv::Scalar(0, 0, 0, 255));
  cut.col(7).setTo(cv::Scalar(200, 210, 220, 0));  // what nobody sees
  folder.write("0.png", cut);
  // Without a hole the colours tell.
  cv::Mat opaque(kHeight, kWidth, CV_8UC4, cv::Scalar(0, 0, 0, 255));
  opaque.col(2).setTo(cv::Scalar(255, 255, 255, 255));
  folder.write("1.png", opaque);
  EXPECT_THAT(columns_for(folder, frame(0)), ElementsAre(5));
  EXPECT_THAT(columns_for(folder, frame(1)), ElementsAre(2));
}

TEST(MaskFiles, ProbabilitiesAreHalvedWhateverTheirRangeInAFrame) {
  const TemporaryFolder folder;
  cv::Mat somebody(kHeight, kWidth, CV_32FC1, cv::Scalar(0.02F)), nobody = somebody.clone();
  somebody.col(4).setTo(0.9F);
  nobody.col(6).setTo(0.1F);
  folder.write("0.tiff", somebody);
  folder.write("1.tiff", nobody);
  EXPECT_THAT(columns_for(folder, frame(0)), ElementsAre(4));
  const FoundMask none = MaskFiles(folder.path(), {}).read(frame(1));
  ASSERT_FALSE(none.mask.empty());
  EXPECT_EQ(cv::countNonZero(none.mask), 0);
}

TEST(MaskFiles, ManyValuesAreNoBlackAndWhiteAndTold) {
  const TemporaryFolder folder;
  cv::Mat instances(64, 250, CV_8UC1);
  for (int x = 0; x < 250; ++x) instances.col(x).setTo(x);
  folder.write("0.png", instances);
  EXPECT_THAT(
      MaskFiles(folder.path(), {}).warnings(),
      Contains(HasSubstr("100 % of what is not black in the masks is grey; what is brighter than half is "
                         "taken out (masks.labels chooses)")));
  // Edges that a network smoothed are not worth a word.
  cv::Mat smooth(64, 64, CV_8UC1, cv::Scalar(0));
  smooth.colRange(20, 44).setTo(255);
  smooth.col(19).setTo(120), smooth.col(44).setTo(90);
  folder.write("0.png", smooth);
  EXPECT_THAT(MaskFiles(folder.path(), {}).warnings(), IsEmpty());
}

TEST(MaskFiles, ThatTakeOutNothingAreTold) {
  const TemporaryFolder folder;
  folder.write("0.png", column(0, 0));
  folder.write("1.png", column(0, 0));
  EXPECT_THAT(MaskFiles(folder.path(), {}).warnings(),
              ElementsAre(HasSubstr("2 masks looked at, nothing is taken out by any")));
}

/// Frames of no picture to speak of, as a sequence.
class PlainFrames final : public FrameSource {
 public:
  explicit PlainFrames(int frames) : frames_(frames) {}
  [[nodiscard]] const std::string& name() const override { return name_; }
  [[nodiscard]] const Camera& camera() const override { return camera_; }
  [[nodiscard]] int size() const override { return frames_; }
  [[nodiscard]] double timestamp(int index) const override { return 1000.0 + 0.1 * index; }
  [[nodiscard]] Frame read(int index) const override {
    return frame(index, fmt::format("{:.6f}", timestamp(index)), timestamp(index));
  }
  [[nodiscard]] FrameTruth truth(int) const override { return {}; }
  [[nodiscard]] const Trajectory& ground_truth() const override { return none_; }
  [[nodiscard]] bool has_depth() const override { return false; }
  [[nodiscard]] bool has_masks() const override { return false; }
  [[nodiscard]] const std::vector<std::string>& warnings() const override { return told_; }

 private:
  int frames_;
  std::string name_ = "kitchen";
  Camera camera_;
  Trajectory none_;
  std::vector<std::string> told_;
};

TEST(MaskFiles, ThatBelongToNoFrameAreRefusedWithTheirNames) {
  const PlainFrames source(4), long_source(200);
  const auto why = [&](const TemporaryFolder& folder, bool is_long = false) {
    Config config;
    config.of<MasksConfig>().sources = folder.path();
    return why_no_mask_fits(config, is_long ? long_source : source);
  };
  EXPECT_EQ(why_no_mask_fits(Config{}, source), "");
  const TemporaryFolder other_day, other_names, other_size, one;
  other_day.write("5000000.000000.png", column(1));
  other_day.write("5000000.100000.png", column(1));
  EXPECT_THAT(why(other_day), AllOf(HasSubstr("kitchen: none of 4 frames has a mask that can be used (frame "
                                              "0, named '1000.000000', 1000.000 s: "),
                                    HasSubstr("has no mask for this frame"),
                                    HasSubstr("its 2 files are of 5000000.000 s to 5000000.100 s")));
  other_names.write("hall.png", column(1));
  EXPECT_THAT(why(other_names), HasSubstr("its one file is named by no numbers, 'hall' first"));
  other_size.write("1000.100000.png", cv::Mat(4, 4, CV_8UC1, cv::Scalar(255)));
  EXPECT_THAT(why(other_size), HasSubstr("none of 4 frames"));
  one.write("1000.300000.png", column(1));  // the last frame's
  EXPECT_EQ(why(one), "");
  // A few frames that somebody outlined are enough, wherever they are.
  const TemporaryFolder outlined;
  outlined.write("1010.100000.png", column(1));  // frame 101
  EXPECT_EQ(why(outlined, true), "");
  EXPECT_THAT(why(other_day, true), HasSubstr("kitchen: none of 200 frames has a mask"));
}

TEST(MaskFiles, WhatIsNearlyAllWhiteIsToldWithTheSwitch) {
  const TemporaryFolder folder;
  for (int i = 0; i < 4; ++i) folder.write(std::to_string(i) + ".png", cv::Mat(255 - column(i)));
  EXPECT_THAT(MaskFiles(folder.path(), {}).warnings(),
              ElementsAre(HasSubstr("94 % of the masks' pixels are said to move; if white is what is static, "
                                    "masks.inverted=true reads them so")));
  MaskReading inverted;
  inverted.inverted = true;
  EXPECT_THAT(MaskFiles(folder.path(), inverted).warnings(), IsEmpty());
  // One image in place of a folder.
  EXPECT_THAT(input_error_of([&] { MaskFiles(folder.path("0.png"), {}); }),
              HasSubstr("0.png: is one image, expected a folder with a mask a frame, or a list of them"));
}

TEST(MaskFiles, WhatIsWrongIsSaid) {
  const TemporaryFolder folder;
  EXPECT_THAT(input_error_of([&] { MaskFiles(folder.path("none"), {}); }),
              HasSubstr("there is no such folder or list of masks"));
  EXPECT_THAT(input_error_of([&] { MaskFiles(folder.path(), {}); }), HasSubstr("holds no mask images"));
  folder.write("0.png", cv::Mat(4, 4, CV_8UC1, cv::Scalar(255)));
  folder.write("1.png", cv::Mat(kHeight, kWidth, CV_8UC1, cv::Scalar(255)));
  folder.write("2.png", std::string("no image"));
  const MaskFiles files(folder.path(), {});
  EXPECT_THAT(files.read(frame(0)).problem, HasSubstr("0.png is 4x4 px, but the frame is 16x8 px"));
  EXPECT_THAT(files.read(frame(1)).problem, HasSubstr("takes out the whole frame and is not used"));
  EXPECT_THAT(files.read(frame(2)).problem, HasSubstr("2.png"));
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(files.read(frame(i)).mask.empty()) << i;
}

class Combined : public testing::Test {
 protected:
  Combined() {
    a.write("0.png", cv::Mat(column(1) | column(2)));
    b.write("0.png", cv::Mat(column(2) | column(3)));
    b.write("1.png", column(9));
    masks().sources = a.path() + " , " + b.path();
  }
  MasksConfig& masks() { return config.of<MasksConfig>(); }
  [[nodiscard]] std::shared_ptr<const OutsideMask> read(int index) const {
    return OutsideMasks(config).read(frame(index));
  }
  TemporaryFolder a, b;
  Config config;
};

TEST_F(Combined, SourcesByUnionOrIntersection) {
  EXPECT_THAT(columns(read(0)->mask), ElementsAre(1, 2, 3));
  ASSERT_EQ(read(0)->sources.size(), 2U);
  masks().combine = "intersection";
  EXPECT_THAT(columns(read(0)->mask), ElementsAre(2));
  // A source without a mask for the frame has no say, and that is told.
  EXPECT_THAT(columns(read(1)->mask), ElementsAre(9));
  EXPECT_THAT(read(1)->problem, HasSubstr("has no mask for this frame"));
}

TEST_F(Combined, GrowByPixels) {
  masks().sources = b.path();
  masks().grow_px = 2;
  EXPECT_THAT(columns(read(1)->mask), ElementsAre(7, 8, 9, 10, 11));
}

TEST_F(Combined, WithAMethodsOwnMask) {
  const Frame at = frame(0);
  MotionInput input{at};
  input.outside = read(0);  // columns 1, 2, 3
  MotionResult result;
  result.mask = cv::Mat(column(3) | column(8));
  result.log_odds = cv::Mat(kHeight, kWidth, CV_32FC1, cv::Scalar(1));
  MotionResult both = result;
  combine_with_outside(masks(), input, both);
  EXPECT_THAT(columns(both.mask), ElementsAre(1, 2, 3, 8));
  EXPECT_DOUBLE_EQ(both.mask_share, 4.0 / kWidth);
  masks().with_method = "intersection";
  combine_with_outside(masks(), input, result);
  EXPECT_THAT(columns(result.mask), ElementsAre(3));
  // What the outside mask calls static weighs whole.
  EXPECT_LT(result.log_odds.at<float>(0, 8), -10.0F);
  EXPECT_EQ(result.log_odds.at<float>(0, 2), 1.0F);
}

TEST_F(Combined, WithJudgedFeatures) {
  masks().with_method = "intersection";
  const Frame at = frame(0);
  std::vector<MotionFeature> features(2);
  features[0].pixel = {8, 4};  // static by the outside mask
  features[1].pixel = {2, 4};
  MotionInput input{at};
  input.features = features;
  input.outside = read(0);
  MotionResult result;
  result.weight_of_feature = {0.0F, 0.0F};
  combine_with_outside(masks(), input, result);
  EXPECT_THAT(result.weight_of_feature, ElementsAre(1.0F, 0.0F));
}

TEST_F(Combined, ASourceThatIsNotThereIsAProblemAndNoThrow) {
  masks().sources = a.path("none");
  const OutsideMasks outside(config);
  EXPECT_TRUE(outside.any());
  EXPECT_THAT(outside.problem(), HasSubstr("there is no such folder"));
  EXPECT_TRUE(outside.read(frame(0))->mask.empty());
}

}  // namespace
}  // namespace stillpoint
