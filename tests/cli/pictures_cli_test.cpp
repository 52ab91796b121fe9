// The pictures that the program writes for others to look at: those inside a report, the paper's figures,
// single panels by a layout's choices, and those of the README.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <regex>

#include "tests/cli/base64_text.hpp"
#include "tests/cli/run_cli.hpp"
#include "tests/cli/small_sequence.hpp"
#include "tests/support/places.hpp"
#include "ui/theme/palette.hpp"

namespace stillpoint {
namespace {

using ::testing::HasSubstr;

/// How many pixels have a colour, to the rounding of packed pictures.
int count_of(const cv::Mat& image, Rgb colour) {
  constexpr int kSlack = 4;
  const cv::Scalar exact(colour.b, colour.g, colour.r);
  cv::Mat same;
  cv::inRange(image, exact - cv::Scalar::all(kSlack), exact + cv::Scalar::all(kSlack), same);
  return cv::countNonZero(same);
}

bool is_plain(const cv::Mat& image) {
  cv::Scalar mean, deviation;
  cv::meanStdDev(image, mean, deviation);
  return cv::norm(deviation) < 8.0;
}

struct PagePicture {
  std::string caption;
  cv::Size told;  ///< in the page
  cv::Mat image;
};

/// The pictures inside a page.
std::vector<PagePicture> pictures_of(const std::string& html) {
  // Not one expression for all of it: the pictures' text is longer than std::regex bears.
  static const std::regex kAfter("^\" width=\"(\\d+)\" height=\"(\\d+)\" alt=\"([^\"]*)\"");
  std::vector<PagePicture> pictures;
  for (std::size_t at = html.find(";base64,"); at != std::string::npos; at = html.find(";base64,", at)) {
    const std::size_t begin = at + 8, end = html.find('"', begin);
    std::smatch told;
    const std::string after = html.substr(end, 400);
    if (!std::regex_search(after, told, kAfter))
      ADD_FAILURE() << "a picture without its size";
    else
      pictures.push_back({told[3],
                          {std::stoi(told[1]), std::stoi(told[2])},
                          cv::imdecode(from_base64(html.substr(begin, end - begin)), cv::IMREAD_COLOR)});
    at = end;
  }
  return pictures;
}

constexpr Rgb kEstimate = role_colour(Role::kEstimate, ThemeName::kLight),
              kBaseline = role_colour(Role::kBaseline, ThemeName::kLight),
              kTruth = role_colour(Role::kGroundTruth, ThemeName::kLight);

TEST(ReportPictures, ShowTheRunsAndTheirWorstFrames) {
  const SmallSequence sequence(10);
  // From frame 5 on there is colour alone.
  std::string depths;
  for (int i = 0; i < 5; ++i)
    depths += fmt::format("{:.4f} {}\n", SmallSequence::stamp(i), SmallSequence::depth(i));
  sequence.folder.write("depth.txt", depths);
  for (const char* method : {"none", "stillpoint"}) {
    const CliResult ran =
        run_cli({"run", sequence.path(), "--method", method, "--out", sequence.path(method)});
    ASSERT_EQ(ran.exit_code, 0) << ran.err;
  }
  const std::string page = sequence.path("report.html");
  const CliResult made =
      run_cli({"report", sequence.path("none"), sequence.path("stillpoint"), "--out", page, "--worst", "5"});
  ASSERT_EQ(made.exit_code, 0) << made.err;

  int plots = 0, compared = 0, trajectories = 0, panels = 0, by_colour = 0;
  for (const PagePicture& picture : pictures_of(sequence.folder.read("report.html"))) {
    SCOPED_TRACE(picture.caption);
    ASSERT_FALSE(picture.image.empty());
    EXPECT_EQ(picture.image.size(), picture.told);
    EXPECT_FALSE(is_plain(picture.image));
    if (picture.caption.starts_with("Translational error")) {
      ++plots;
      EXPECT_EQ(picture.told, cv::Size(1130, 300));
      EXPECT_GT(count_of(picture.image, kEstimate), 200);
      // Where nothing moves both runs are one line; the legend shows both.
      EXPECT_GT(count_of(picture.image, kBaseline), 8);
    } else if (picture.told == cv::Size(720, 560)) {
      ++trajectories;
      EXPECT_GT(count_of(picture.image, kEstimate), 100);
      EXPECT_GT(count_of(picture.image, kTruth), 20);
    } else if (picture.caption.starts_with("All runs in one scale") ||
               picture.caption.ends_with("over time, all runs")) {
      ++compared;
      EXPECT_GT(picture.told.width, 1000);
    } else {
      ++panels;
      EXPECT_EQ(picture.told, cv::Size(640, 540));
    }
    by_colour += picture.caption.find("What method epipolar judges by") != std::string::npos ? 1 : 0;
  }
  EXPECT_GE(plots, 1);
  EXPECT_EQ(trajectories, 2);
  EXPECT_EQ(compared, 7);  // paths; x, y, z; roll, pitch, yaw
  EXPECT_GE(panels, 6);
  EXPECT_GE(by_colour, 1);
}

TEST(FigurePictures, HoldWhatTheirListSays) {
  const std::string where = "generated:walking_xyz";
  const TemporaryFolder out;
  const CliResult made = run_cli({"figures", where, "--frames", "12", "--method", "paper", "--frame", "8",
                                  "--scale", "0.5", "--out", out.path("f")});
  ASSERT_EQ(made.exit_code, 0) << made.err;
  const auto figure = [&](const std::string& name) {
    return cv::imread(out.path("f/figure" + name + ".png"));
  };
  // The parts are a frame's size; the masks are black and white, and the union holds the forward mask.
  for (const char* part : {"1a", "1b", "1c", "1d", "1e", "1f"})
    ASSERT_EQ(figure(part).size(), cv::Size(640, 480)) << part;
  EXPECT_FALSE(is_plain(figure("1c")));
  const cv::Mat forward = figure("1d"), united = figure("1f");
  EXPECT_GT(count_of(united, {255, 255, 255}), 50);
  EXPECT_EQ(count_of(united, {255, 255, 255}) + count_of(united, {0, 0, 0}), 640 * 480);
  const cv::Mat outside = forward & ~united;
  EXPECT_EQ(cv::countNonZero(outside.reshape(1)), 0);
  // The sheet shows the parts at half their size, three to a row.
  EXPECT_GT(figure("1").cols, 3 * 320);
  EXPECT_LT(figure("1").cols, 3 * 320 + 120);
  for (const char* panel : {"3", "4", "6"}) EXPECT_EQ(figure(panel).size(), cv::Size(960, 780)) << panel;
  EXPECT_GT(count_of(figure("3"), role_colour(Role::kKept, ThemeName::kLight)), 1000);
  EXPECT_GT(count_of(figure("3"), role_colour(Role::kRemoved, ThemeName::kLight)), 50);
  EXPECT_GT(count_of(figure("6"), kEstimate), 200);
  EXPECT_GT(count_of(figure("6"), kBaseline), 100);
}

TEST(PanelPictures, TakeTheChoicesOfALayout) {
  const SmallSequence sequence(4);
  const auto picture = [&](const std::string& name, const std::string& layout, const std::string& warning) {
    std::vector<std::string> arguments = {"snapshot", sequence.path(), "--frames", "3",
                                          "--panels", "compensated",   "--out",    sequence.path(name),
                                          "--beside", "paper"};
    if (!layout.empty()) {
      sequence.folder.write(name + ".json", layout);
      arguments.insert(arguments.end(), {"--layout", sequence.path(name + ".json")});
    }
    const CliResult made = run_cli(arguments);
    EXPECT_EQ(made.exit_code, 0) << made.err;
    if (warning.empty())
      EXPECT_THAT(made.err, ::testing::Not(HasSubstr("warning")));
    else
      EXPECT_THAT(made.err, HasSubstr(warning));
    return cv::imread(sequence.path(name) + "/000003_compensated.png");
  };
  const auto chosen = [](const std::string& look) {
    return R"({"columns": [{"panel": "input"}, {"panel": "compensated", "choices": {"look": ")" + look +
           R"("}}]})";
  };
  const cv::Mat plain = picture("plain", "", ""), same = picture("same", chosen("Image"), ""),
                wiped = picture("wiped", chosen("Wipe"), ""),
                difference = picture("difference", chosen("Signed difference"), ""),
                unknown = picture("unknown", chosen("Wip"),
                                  "unknown.json: no control could take compensated: look=Wip");
  ASSERT_FALSE(plain.empty());
  EXPECT_EQ(cv::norm(plain, same, cv::NORM_INF), 0.0);
  EXPECT_EQ(cv::norm(plain, unknown, cv::NORM_INF), 0.0);
  EXPECT_GT(cv::norm(plain, wiped, cv::NORM_INF), 50.0);
  // The wall is static, so nearly all of its difference is the ground of the scale.
  EXPECT_GT(cv::norm(plain, difference, cv::NORM_L1) / static_cast<double>(plain.total()), 50.0);
}

TEST(ReadmePictures, AreWhatTheProgramMakes) {
  const std::string root = places::source();
  const TemporaryFolder out;
  const CliResult made = CliProcess({places::program(), out.path()}, root + "/tests/update_pictures").wait();
  ASSERT_EQ(made.exit_code, 0) << made.err;
  for (const auto& picture : std::filesystem::directory_iterator(root + "/assets/pictures")) {
    const std::string name = picture.path().filename().string();
    const cv::Mat kept = cv::imread(picture.path().string()), now = cv::imread(out.path(name));
    ASSERT_FALSE(now.empty()) << name;
    ASSERT_EQ(kept.size(), now.size()) << name;
    // What they tell must hold, not each pixel: figures move a little with the method.
    cv::Mat small_kept, small_now;
    cv::resize(kept, small_kept, {}, 0.125, 0.125, cv::INTER_AREA);
    cv::resize(now, small_now, {}, 0.125, 0.125, cv::INTER_AREA);
    constexpr double kMeanGreyLevels = 5.0;
    EXPECT_LT(cv::norm(small_kept, small_now, cv::NORM_L1) / (3.0 * static_cast<double>(small_now.total())),
              kMeanGreyLevels)
        << name << " is out of date: tests/update_pictures makes it anew";
  }
}

}  // namespace
}  // namespace stillpoint
