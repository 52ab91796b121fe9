#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <thread>
#include <vector>

#include "tests/cli/run_cli.hpp"
#include "tests/unit/motion_scene.hpp"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;
using motion_test::plane_and_patch;
using motion_test::PlaneAndPatch;

std::ptrdiff_t lines_of(const std::string& text) { return std::count(text.begin(), text.end(), '\n'); }

PlaneAndPatch small_scene() { return plane_and_patch({320, 240}, {130, 60, 60, 110}, {21, -2}, 16); }

cv::Mat in_colour(const cv::Mat& gray) {
  cv::Mat colour;
  cv::applyColorMap(gray, colour, cv::COLORMAP_BONE);
  return colour;
}

class MotionCommand : public ::testing::Test {
 protected:
  MotionCommand() {
    const PlaneAndPatch scene = small_scene();
    folder_.write("a.png", scene.reference);
    folder_.write("b.png", scene.target);
    folder_.write("a_colour.png", in_colour(scene.reference));
    folder_.write("b_colour.jpg", in_colour(scene.target));
  }
  [[nodiscard]] static CliResult motion(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "motion");
    return run_cli(arguments);
  }
  /// The command on two of the folder's files.
  [[nodiscard]] CliResult pair(const std::string& a, const std::string& b,
                               std::vector<std::string> more = {}) const {
    more.insert(more.begin(), {folder_.path(a), folder_.path(b), "--out", folder_.path("out")});
    return motion(more);
  }
  /// A sequence of `count` colour frames alone.
  void write_sequence(int count) const {
    std::string list = "# timestamp filename\n";
    for (int i = 0; i < count; ++i) {
      const std::string name = "rgb/" + std::to_string(i) + ".png";
      const PlaneAndPatch scene = plane_and_patch({320, 240}, {100 + 6 * i, 60, 60, 110}, {6, 0}, 16);
      folder_.write("frames/" + name, in_colour(scene.target));
      list += std::to_string(i) + ".5 " + name + "\n";
    }
    folder_.write("frames/rgb.txt", list);
  }
  TemporaryFolder folder_;
};

/// The stage of a frame in motion.json; of round `round` (from 1) where it has rounds.
nlohmann::json stage_of(const nlohmann::json& frame, const std::string& id, int round = 0) {
  for (const nlohmann::json& stage : frame["stages"])
    if (stage["id"] == id && (round == 0 || stage["round"] == round)) return stage;
  ADD_FAILURE() << "there is no stage " << id;
  return {};
}

double figure_of(const nlohmann::json& stage, const std::string& name) {
  for (const nlohmann::json& figure : stage["figures"])
    if (figure["name"] == name) return figure["value"];
  ADD_FAILURE() << "there is no figure " << name;
  return 0.0;
}

TEST_F(MotionCommand, TwoGreyImagesLeaveEveryPicture) {
  const CliResult ended = pair("a.png", "b.png");
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  for (const char* name :
       {"compensated", "compensated_backward", "difference", "difference_backward", "raw_forward_mask",
        "raw_backward_mask", "forward_mask", "backward_mask", "warped_backward_mask", "union_mask", "mask"}) {
    const cv::Mat picture =
        cv::imread(folder_.path(std::string("out/") + name + ".png"), cv::IMREAD_UNCHANGED);
    EXPECT_EQ(picture.size(), cv::Size(320, 240)) << name;
    EXPECT_EQ(picture.type(), CV_8UC1) << name;
  }
  for (const char* name : {"overlay", "flow_tracks", "flow_tracks_backward"}) {
    const cv::Mat picture = cv::imread(folder_.path(std::string("out/") + name + ".png"));
    EXPECT_EQ(picture.cols, 320) << name;
    EXPECT_GT(picture.rows, 240) << name << " has no legend";
  }
  const cv::Mat mask = cv::imread(folder_.path("out/mask.png"), cv::IMREAD_UNCHANGED);
  EXPECT_GT(cv::countNonZero(mask(cv::Rect(130, 60, 60, 110))), 60 * 110 * 8 / 10);
  EXPECT_EQ(cv::norm(mask, cv::imread(folder_.path("out/union_mask.png"), cv::IMREAD_UNCHANGED)), 0.0);
  EXPECT_EQ(lines_of(folder_.read("out/motion.csv")), 2);
  const auto figures = nlohmann::json::parse(folder_.read("out/motion.json"));
  EXPECT_EQ(figures["method"], "paper");
  EXPECT_EQ(figures["reference_gap"], 1);
  const nlohmann::json& frame = figures["pairs"][0];
  EXPECT_EQ(frame["reference"], folder_.path("a.png"));
  EXPECT_EQ(frame["target"], folder_.path("b.png"));
  EXPECT_NEAR(frame["mask_share"].get<double>(), cv::countNonZero(mask) / (320.0 * 240.0), 1e-9);
  EXPECT_GT(figure_of(stage_of(frame, "homography", 1), "Forward: inliers"), 50);
  EXPECT_EQ(figure_of(stage_of(frame, "union", 1), "Regions"), frame["regions"].size());
}

TEST_F(MotionCommand, TheOverlayColoursTheMaskAlone) {
  ASSERT_EQ(pair("a.png", "b.png").exit_code, 0);
  const cv::Mat overlay = cv::imread(folder_.path("out/overlay.png"))(cv::Rect(0, 0, 320, 240));
  const cv::Mat mask = cv::imread(folder_.path("out/mask.png"), cv::IMREAD_UNCHANGED);
  cv::Mat tinted;
  std::vector<cv::Mat> channels;
  cv::split(overlay, channels);
  cv::compare(channels[0], channels[2], tinted, cv::CMP_NE);
  EXPECT_GT(cv::countNonZero(tinted), cv::countNonZero(mask) * 8 / 10);  // but for the regions' boxes
  EXPECT_EQ(cv::countNonZero(tinted & ~mask), 0);
}

TEST_F(MotionCommand, CsvRowsHaveAsManyFieldsAsTheirHeading) {
  folder_.write("a, \"left\".png", small_scene().reference);
  for (const char* reference : {"a.png", "a, \"left\".png"}) {
    ASSERT_EQ(pair(reference, "b.png", {"--force"}).exit_code, 0);
    const std::string csv = folder_.read("out/motion.csv");
    const std::string heading = csv.substr(0, csv.find('\n')), row = csv.substr(csv.find('\n') + 1);
    EXPECT_EQ(heading, "reference,target,mask_share,regions,rounds,static_tracks,homography_rms,note");
    std::ptrdiff_t fields = 1;
    bool quoted = false;
    for (const char letter : row) {
      if (letter == '"') quoted = !quoted;
      if (letter == ',' && !quoted) ++fields;
    }
    EXPECT_EQ(fields, std::count(heading.begin(), heading.end(), ',') + 1) << row;
    EXPECT_FALSE(quoted) << row;
  }
  EXPECT_THAT(folder_.read("out/motion.csv"), ::testing::HasSubstr("a, \"\"left\"\".png\","));
}

TEST_F(MotionCommand, ColourImagesAndOtherFormatsWork) {
  const CliResult ended = pair("a_colour.png", "b_colour.jpg", {"--all-rounds"});
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_TRUE(fs::exists(folder_.path("out/round_1/union_mask.png")));
  EXPECT_FALSE(fs::exists(folder_.path("out/union_mask.png")));
  EXPECT_TRUE(fs::exists(folder_.path("out/overlay.png")));
}

TEST_F(MotionCommand, EarlierResultsAreKeptWithoutForce) {
  ASSERT_EQ(pair("a.png", "b.png").exit_code, 0);
  const std::string before = folder_.read("out/motion.csv");
  expect_one_sentence(pair("b.png", "a.png"), "--force");
  EXPECT_EQ(folder_.read("out/motion.csv"), before);
  EXPECT_EQ(pair("b.png", "a.png", {"--force"}).exit_code, 0);
  EXPECT_NE(folder_.read("out/motion.csv"), before);
}

TEST_F(MotionCommand, ForcedResultsReplaceEarlierOnesWhole) {
  write_sequence(6);
  const auto forced = [this](std::vector<std::string> more) {
    more.insert(more.begin(), {folder_.path("frames"), "--out", folder_.path("out"), "--force"});
    return motion(more).exit_code;
  };
  ASSERT_EQ(forced({"--frames", "1:6", "--all-rounds"}), 0);
  ASSERT_TRUE(fs::exists(folder_.path("out/000004/round_1/union_mask.png")));
  ASSERT_TRUE(fs::exists(folder_.path("out/000004/overlay.png")));
  folder_.write("out/000004/notes.txt", std::string("mine"));
  folder_.write("out/000004/sketch.png", std::string("mine as well"));
  folder_.write("out/figures/overlay.png", std::string("mine too"));
  ASSERT_EQ(forced({"--frames", "1:3"}), 0);
  EXPECT_TRUE(fs::exists(folder_.path("out/000002/overlay.png")));
  EXPECT_FALSE(fs::exists(folder_.path("out/000002/round_1")));
  EXPECT_FALSE(fs::exists(folder_.path("out/000003")));
  // What is not ours stays.
  EXPECT_EQ(folder_.read("out/000004/notes.txt"), "mine");
  EXPECT_EQ(folder_.read("out/000004/sketch.png"), "mine as well");
  EXPECT_FALSE(fs::exists(folder_.path("out/000004/round_1")));
  EXPECT_FALSE(fs::exists(folder_.path("out/000004/overlay.png")));
  EXPECT_EQ(folder_.read("out/figures/overlay.png"), "mine too");
  // Another method's pictures go with the earlier result too.
  ASSERT_EQ(forced({"--frames", "1:3", "--method", "epipolar"}), 0);
  EXPECT_TRUE(fs::exists(folder_.path("out/000002/points.png")));
  EXPECT_FALSE(fs::exists(folder_.path("out/000002/union_mask.png")));
}

TEST_F(MotionCommand, AListOfPicturesDoesNotLeadElsewhere) {
  ASSERT_EQ(pair("a.png", "b.png").exit_code, 0);
  folder_.write("mine.png", std::string("mine"));
  folder_.write("out/mine.txt", std::string("mine"));
  folder_.write("out/motion.json",
                std::string(R"({"pictures": ["../mine.png", "mine.txt", 3, "union_mask.png"]})"));
  ASSERT_EQ(pair("a.png", "b.png", {"--force"}).exit_code, 0);
  EXPECT_EQ(folder_.read("mine.png"), "mine");
  EXPECT_EQ(folder_.read("out/mine.txt"), "mine");
  folder_.write("out/motion.json", std::string("no json at all"));
  EXPECT_EQ(pair("a.png", "b.png", {"--force"}).exit_code, 0);
}

/// Sends the signal once the file `sign` is there, and waits for the end.
CliResult stopped(const std::vector<std::string>& arguments, const fs::path& sign) {
  CliProcess process(arguments);
  for (int i = 0; i < 1200 && !fs::exists(sign); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  EXPECT_TRUE(fs::exists(sign)) << sign;
  process.send(SIGINT);
  return process.wait();
}

TEST_F(MotionCommand, CtrlCKeepsWhatWasDone) {
  const CliResult result = stopped({"motion", "generated:room", "--out", folder_.path("out")},
                                   folder_.path("out/000002/overlay.png"));
  EXPECT_EQ(result.exit_code, 128 + SIGINT) << result.err;
  EXPECT_FALSE(result.by_signal);
  const auto figures = nlohmann::json::parse(folder_.read("out/motion.json"));
  EXPECT_GE(figures["pairs"].size(), 2U);
  EXPECT_LT(figures["pairs"].size(), 299U);
  EXPECT_EQ(lines_of(folder_.read("out/motion.csv")), 1 + static_cast<int>(figures["pairs"].size()));
}

TEST(GenerateCommand, CtrlCLeavesAShorterSequence) {
  const TemporaryFolder folder("film");
  const CliResult result = stopped({"generate", "room", "--frames", "500", "--out", folder.path()},
                                   folder.path() + ".part/rgb/1000.033333.png");
  EXPECT_EQ(result.exit_code, 128 + SIGINT) << result.err;
  EXPECT_FALSE(result.by_signal);
  const CliResult ran = run_cli({"motion", folder.path(), "--frames", "1:2", "--out", folder.path("motion")});
  EXPECT_EQ(ran.exit_code, 0) << ran.err;
  std::size_t images = 0;
  for ([[maybe_unused]] const auto& image : fs::directory_iterator(folder.path("rgb"))) ++images;
  EXPECT_LT(images, 500U);
  EXPECT_EQ(static_cast<std::size_t>(lines_of(folder.read("rgb.txt"))), images + 2);  // and two of comment
}

TEST_F(MotionCommand, BadInputIsToldInOneSentence) {
  folder_.write("empty.png", "");
  folder_.write("words.png", "this is no picture");
  folder_.write("large.png", motion_test::textured_image({400, 300}, 1));
  folder_.write("file", "");
  folder_.write("bare/readme", "no rgb.txt here");
  expect_one_sentence(pair("a.png", "missing.png"), "missing.png");
  expect_one_sentence(pair("empty.png", "b.png"), "empty.png");
  expect_one_sentence(pair("a.png", "words.png"), "words.png");
  expect_one_sentence(pair("a.png", "large.png"), "400x300");
  expect_one_sentence(pair("a.png", "b.png", {"--set", "motion.nothing=1"}), "motion.nothing");
  expect_one_sentence(pair("a.png", "b.png", {"--set", "motion.max_rounds=0"}), "motion.max_rounds");
  expect_one_sentence(pair("a.png", "b.png", {"--set", "paper.max_rounds=0"}), "paper.max_rounds");
  expect_one_sentence(pair("a.png", "b.png", {"--config", "nosuchpreset"}), "nosuchpreset");
  expect_usage_error(pair("a.png", "b.png", {"--frames", "1:2"}), "--frames");
  EXPECT_FALSE(fs::exists(folder_.path("out")));
  for (const char* out : {"file", "file/below"})
    expect_one_sentence(motion({folder_.path("a.png"), folder_.path("b.png"), "--out", folder_.path(out)}),
                        "file");
  expect_one_sentence(motion({folder_.path("bare"), "--out", folder_.path("out")}), "rgb.txt");
  expect_one_sentence(motion({folder_.path("a.png"), "--out", folder_.path("out")}), "a.png");
}

TEST_F(MotionCommand, MethodsThatNeedMoreThanImagesAreRefused) {
  for (const char* method : {"none", "oracle", "nosuchmethod"}) {
    const CliResult ended = pair("a.png", "b.png", {"--method", method});
    expect_one_sentence(ended, method);
    for (const char* other : {"paper", "epipolar", "stillpoint"})
      EXPECT_THAT(ended.err, ::testing::HasSubstr(other));
  }
  for (const char* method : {"epipolar", "stillpoint"})
    expect_one_sentence(pair("a.png", "b.png", {"--method", method}),
                        std::string(method) + " follows what is dynamic over several frames");
  EXPECT_FALSE(fs::exists(folder_.path("out")));
}

TEST_F(MotionCommand, ImagesWithoutTextureEndWellWithANote) {
  for (const cv::Size size : {cv::Size(1, 1), cv::Size(200, 100)}) {
    folder_.write("blank.png", cv::Mat(cv::Mat::zeros(size, CV_8UC3)));
    const CliResult ended = pair("blank.png", "blank.png", {"--force"});
    EXPECT_EQ(ended.exit_code, 0) << ended.err;
    EXPECT_THAT(ended.out, ::testing::HasSubstr("no mask"));
    EXPECT_FALSE(fs::exists(folder_.path("out/union_mask.png")));
    EXPECT_FALSE(fs::exists(folder_.path("out/mask.png")));
  }
}

TEST_F(MotionCommand, SequencesOfColourFramesAlone) {
  write_sequence(6);
  const auto sequence = [this](const std::string& out, std::vector<std::string> more = {}) {
    more.insert(more.begin(), {folder_.path("frames"), "--out", folder_.path(out)});
    return motion(more);
  };
  ASSERT_EQ(sequence("out").exit_code, 0);
  EXPECT_EQ(lines_of(folder_.read("out/motion.csv")), 1 + 5);
  EXPECT_FALSE(fs::exists(folder_.path("out/000000")));
  EXPECT_TRUE(fs::exists(folder_.path("out/000005/overlay.png")));

  ASSERT_EQ(sequence("out2", {"--frames", "0:6:2", "--set", "motion.reference_gap=2"}).exit_code, 0);
  const auto figures = nlohmann::json::parse(folder_.read("out2/motion.json"));
  ASSERT_EQ(figures["pairs"].size(), 2U);  // targets 2 and 4: frame 0 has nothing two frames back
  EXPECT_EQ(figures["pairs"][1]["reference"], "2");
  EXPECT_EQ(figures["pairs"][1]["target"], "4");
  for (const char* wrong : {"x", "3:2", "1:2:0", "1:2:3:4", "9:12"})
    expect_one_sentence(sequence("out3", {"--frames", wrong}), "--frames");
  expect_one_sentence(sequence("out3", {"--set", "motion.reference_gap=6"}), "6 frames back");
  EXPECT_FALSE(fs::exists(folder_.path("out3")));
}

TEST_F(MotionCommand, FramesJudgedAloneAreAsOnTheWayThrough) {
  write_sequence(5);
  const auto sequence = [this](const std::string& out, const std::string& frames) {
    return motion({folder_.path("frames"), "--out", folder_.path(out), "--frames", frames}).exit_code;
  };
  ASSERT_EQ(sequence("all", "0:5"), 0);
  ASSERT_EQ(sequence("one", "3"), 0);
  EXPECT_EQ(folder_.read("one/000003/mask.png"), folder_.read("all/000003/mask.png"));
  EXPECT_EQ(folder_.read("one/000003/flow_tracks.png"), folder_.read("all/000003/flow_tracks.png"));
}

TEST_F(MotionCommand, MethodsWithStateSeeEveryFrameAndWriteThoseChosen) {
  write_sequence(10);
  folder_.truncate("frames/rgb/8.png", 0.5);
  const auto sequence = [this](const std::string& out, std::vector<std::string> more) {
    more.insert(more.begin(), {folder_.path("frames"), "--out", folder_.path(out)});
    return motion(more);
  };
  const CliResult all = sequence("all", {"--method", "epipolar"});
  ASSERT_EQ(all.exit_code, 0) << all.err;
  const CliResult some = sequence("some", {"--method", "stillpoint", "--frames", "6:10:2"});
  ASSERT_EQ(some.exit_code, 0) << some.err;
  EXPECT_THAT(some.out, ::testing::HasSubstr("stillpoint judges frames without depth by epipolar"));
  EXPECT_THAT(all.out, ::testing::Not(::testing::HasSubstr("without depth")));

  const auto figures = nlohmann::json::parse(folder_.read("all/motion.json")),
             chosen = nlohmann::json::parse(folder_.read("some/motion.json"));
  EXPECT_EQ(chosen["method"], "epipolar");
  ASSERT_EQ(figures["pairs"].size(), 10U);
  ASSERT_EQ(chosen["pairs"].size(), 2U);  // 6 and 8
  EXPECT_EQ(chosen["pairs"][0]["target"], "6");
  EXPECT_TRUE(chosen["pairs"][0]["reference"].is_null());
  EXPECT_EQ(chosen["pairs"][0]["mask_share"], figures["pairs"][6]["mask_share"]);
  EXPECT_EQ(figure_of(stage_of(chosen["pairs"][0], "points"), "Points"),
            figure_of(stage_of(figures["pairs"][6], "points"), "Points"));
  EXPECT_THAT(chosen["pairs"][1]["note"].get<std::string>(), ::testing::HasSubstr("8.png"));
  EXPECT_TRUE(chosen["pairs"][1]["mask_share"].is_null());
  EXPECT_FALSE(fs::exists(folder_.path("some/000005")));
  EXPECT_FALSE(fs::exists(folder_.path("some/000008")));

  for (const char* name : {"mask", "evidence"}) {
    const cv::Mat picture =
        cv::imread(folder_.path(std::string("some/000006/") + name + ".png"), cv::IMREAD_UNCHANGED);
    EXPECT_EQ(picture.size(), cv::Size(320, 240)) << name;
    EXPECT_EQ(picture.type(), CV_8UC1) << name;
    EXPECT_EQ(folder_.read(std::string("some/000006/") + name + ".png"),
              folder_.read(std::string("all/000006/") + name + ".png"));
  }
  EXPECT_GT(cv::imread(folder_.path("some/000006/points.png")).rows, 240);
  EXPECT_EQ(lines_of(folder_.read("some/motion.csv")), 3);
}

TEST_F(MotionCommand, ADamagedFrameIsMarkedAndTheRestGoesOn) {
  write_sequence(5);
  folder_.truncate("frames/rgb/2.png", 0.5);
  const CliResult ended = motion({folder_.path("frames"), "--out", folder_.path("out")});
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  const auto figures = nlohmann::json::parse(folder_.read("out/motion.json"));
  ASSERT_EQ(figures["pairs"].size(), 4U);
  EXPECT_EQ(figures["pairs"][0]["note"], "");
  EXPECT_NE(figures["pairs"][1]["note"].get<std::string>().find("2.png"), std::string::npos);
  EXPECT_NE(figures["pairs"][2]["note"].get<std::string>().find("2.png"), std::string::npos);
  EXPECT_EQ(figures["pairs"][3]["note"], "");
  EXPECT_FALSE(fs::exists(folder_.path("out/000002")));

  // Only the frame itself and its reference count: between them lies nothing that is looked at.
  const CliResult wide = motion({folder_.path("frames"), "--out", folder_.path("wide"), "--set",
                                 "paper.reference_gap=2", "--frames", "2:5"});
  ASSERT_EQ(wide.exit_code, 0) << wide.err;
  const auto wider = nlohmann::json::parse(folder_.read("wide/motion.json"));
  ASSERT_EQ(wider["pairs"].size(), 3U);
  EXPECT_EQ(wider["pairs"][1]["note"], "");
  EXPECT_EQ(wider["pairs"][1]["reference"], "1");
  EXPECT_TRUE(fs::exists(folder_.path("wide/000003/overlay.png")));
  EXPECT_NE(wider["pairs"][2]["note"].get<std::string>().find("2.png"), std::string::npos);
}

}  // namespace
}  // namespace stillpoint
