// Interactive reports: one page, whatever names, lost frames and room there are.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <set>

#include "app/report/html.hpp"
#include "tests/cli/base64_text.hpp"
#include "tests/cli/csv_rows.hpp"
#include "tests/cli/live_report_example.hpp"
#include "tests/cli/run_cli.hpp"
#include "tests/cli/small_sequence.hpp"
#include "tests/support/places.hpp"

namespace stillpoint {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

using LiveReport = LiveReportExample;

nlohmann::json page_data(const std::string& html) {
  const std::string text =
      between(html, "<script type=\"application/json\" id=\"report-data\">", "</script>");
  EXPECT_TRUE(nlohmann::json::accept(text));
  return nlohmann::json::parse(text, nullptr, false);
}

TEST_F(LiveReport, IsOnePageThatNeedsNothingElse) {
  const CliResult made = report("live.html");
  ASSERT_EQ(made.exit_code, 0) << made.err;
  EXPECT_THAT(made.out, HasSubstr("Pictures of 9 of 10 frames, 320 px wide."));
  const std::string html = page("live.html");
  for (const char* outside : {"http://", "https://", " src=\"/", " src=\"h", "url(", "@import", "import(",
                              "fetch(", "XMLHttpRequest", "<link"})
    EXPECT_THAT(html, Not(HasSubstr(outside)));
  EXPECT_THAT(html, HasSubstr("<noscript>"));
  for (const char* part : {"Stage timings", "Worst frames of stillpoint", "run.method", "id=\"orbit\""})
    EXPECT_THAT(html, HasSubstr(part));
  // The same runs give the same bytes; the page of old has no scripts.
  ASSERT_EQ(report("again.html").exit_code, 0);
  const auto without_command = [](std::string text) {
    // The page names the command that made it, and with it itself.
    const std::size_t from = text.find("<section class=\"made\">"), to = text.find("</section>", from);
    return from == std::string::npos || to == std::string::npos ? text : text.erase(from, to - from);
  };
  EXPECT_THAT(html, HasSubstr("live.html</td>"));
  EXPECT_TRUE(without_command(page("again.html")) == without_command(html));
  ASSERT_EQ(run_cli({"report", run("none"), "--worst", "0", "--out", sequence_.path("plain.html")}).exit_code,
            0);
  EXPECT_THAT(page("plain.html"), Not(HasSubstr("<script")));
}

TEST_F(LiveReport, HasTheFiguresOfTheRecords) {
  ASSERT_EQ(report("live.html").exit_code, 0);
  const nlohmann::json data = page_data(page("live.html"));
  const auto& runs = data.at("sequences").at(0).at("runs");
  ASSERT_EQ(runs.size(), 2U);
  int known = 0, unknown = 0;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const std::string method = i == 0 ? "none" : "stillpoint";
    EXPECT_EQ(runs[i].at("name"), method);
    const auto rows = csv_rows(page("runs/" + method + "/frames.csv"));
    ASSERT_EQ(rows.size(), static_cast<std::size_t>(kFrames));
    for (std::size_t row = 0; row < rows.size(); ++row) {
      EXPECT_EQ(runs[i].at("status").at(row), rows[row].at("status"));
      EXPECT_EQ(runs[i].at("note").at(row), rows[row].at("note"));
      EXPECT_EQ(runs[i].at("frames").at(row), row);
      EXPECT_NEAR(runs[i].at("seconds").at(row).get<double>(), static_cast<double>(row) / 30.0, 1e-4);
      const std::map<std::string, std::string> columns = {
          {"rpe", "rpe_frame_m"}, {"ate", "ate_m"}, {"mask", "mask_share"}, {"inliers", "inliers"}};
      for (const auto& [name, column] : columns) {
        const nlohmann::json& value = runs[i].at("figures").at(name).at(row);
        const std::string& text = rows[row].at(column);
        EXPECT_EQ(value.is_null(), text.empty()) << name << " of frame " << row;
        if (!value.is_null() && !text.empty()) {
          EXPECT_DOUBLE_EQ(value.get<double>(), std::stod(text));
        }
        ++(value.is_null() ? unknown : known);
      }
    }
    // What could not be read is a gap, not a place.
    EXPECT_TRUE(runs[i].at("positions").at(kUnreadable).is_null());
    EXPECT_TRUE(runs[i].at("turns").at(kUnreadable).is_null());
    EXPECT_TRUE(runs[i].at("figures").at("mask").at(kUnreadable).is_null());
    // Laid over the truth, which goes along x: 2 px a frame.
    for (const int frame : {0, 3, 9})
      EXPECT_NEAR(runs[i].at("positions").at(static_cast<std::size_t>(frame)).at(0).get<double>(),
                  frame * 2 * SmallSequence::kDepth / SmallSequence::kFocal, 0.004);
  }
  EXPECT_GT(known, 50);
  EXPECT_GT(unknown, 5);
}

TEST_F(LiveReport, LaysMasksAndLayersOverPictures) {
  ASSERT_EQ(run_cli({"run", sequence_.path(), "--method", "paper", "--out", run("paper")}).exit_code, 0);
  const CliResult made = run_cli({"report", "--layers", "difference", run("none"), run("stillpoint"),
                                  run("paper"), "--interactive", "--worst", "0", "--picture-width", "160",
                                  "--out", sequence_.path("live.html")});
  ASSERT_EQ(made.exit_code, 0) << made.err;
  const nlohmann::json pictures = page_data(page("live.html")).at("sequences").at(0).at("pictures");
  EXPECT_EQ(pictures.at("size"), nlohmann::json({160, 120}));
  EXPECT_EQ(pictures.at("layers"), nlohmann::json({"difference"}));
  std::set<int> frames;
  const auto decoded = [](const nlohmann::json& text) {
    return cv::imdecode(from_base64(text.get<std::string>()), cv::IMREAD_UNCHANGED);
  };
  for (const nlohmann::json& picture : pictures.at("frames")) {
    const int frame = picture.at("frame");
    SCOPED_TRACE(frame);
    frames.insert(frame);
    const auto& runs = picture.at("runs");
    EXPECT_EQ(decoded(picture.at("colour")).size(), cv::Size(160, 120));
    EXPECT_FALSE(runs.at(0).contains("mask"));
    ASSERT_EQ(runs.at(1).contains("mask"), frame != 0);
    if (frame != 0) {
      // The square is covered, at half its size; far from it nothing is.
      const cv::Mat mask = decoded(runs.at(1).at("mask"));
      ASSERT_EQ(mask.type(), CV_8UC4);
      EXPECT_EQ(mask.at<cv::Vec4b>(50, 20 + 2 * frame + 20)[3], 255);
      EXPECT_EQ(mask.at<cv::Vec4b>(5, 150)[3], 0);
    }
    // Four bytes a feature: as many as the records have.
    const auto features = from_base64(runs.at(0).at("features").get<std::string>());
    EXPECT_EQ(std::to_string(features.size() / 4),
              csv_rows(page("runs/none/frames.csv"))[static_cast<std::size_t>(frame)].at("features_found"));
    EXPECT_TRUE(runs.at(0).at("layers").at(0).is_null());
    EXPECT_EQ(runs.at(2).at("layers").at(0).is_null(), frame == 0);
    if (frame != 0) {
      EXPECT_EQ(decoded(runs.at(2).at("layers").at(0)).size(), cv::Size(160, 120));
    }
  }
  EXPECT_EQ(frames, (std::set<int>{0, 1, 2, 3, 4, 5, 7, 8, 9}));
}

TEST_F(LiveReport, LeavesFramesOutRatherThanGrow) {
  const CliResult whole = report("whole.html"), half = report("half.html", {"--picture-mb", "0.15"}),
                  none = report("none.html", {"--picture-mb", "0"});
  ASSERT_EQ(half.exit_code, 0) << half.err;
  EXPECT_THAT(half.out, HasSubstr("one in "));
  EXPECT_THAT(half.out, HasSubstr("--picture-mb"));
  EXPECT_THAT(none.out, HasSubstr("No pictures: No picture had room"));
  const auto pictures_in = [this](const char* name) {
    return page_data(page(name)).at("sequences").at(0).at("pictures");
  };
  const auto all = pictures_in("whole.html"), some = pictures_in("half.html");
  EXPECT_EQ(all.at("frames").size(), 9U);
  EXPECT_GT(all.dump().size(), 150000U);
  EXPECT_GT(some.at("frames").size(), 1U);
  EXPECT_LT(some.at("frames").size(), 9U);
  EXPECT_LT(some.at("frames").dump().size(), 151000U);
  EXPECT_THAT(half.out, HasSubstr(some.at("told").get<std::string>()));  // page and command line say the same
  EXPECT_EQ(pictures_in("none.html").at("frames").size(), 0U);
}

TEST_F(LiveReport, WhatIsWrongIsToldInOneSentence) {
  expect_one_sentence(report("live.html", {"--layers", "nonsense"}),
                      "--layers nonsense: no stage of any frame has a layer of that id");
  EXPECT_FALSE(std::filesystem::exists(sequence_.path("live.html")));
  const CliResult alone =
      run_cli({"report", run("none"), "--layers", "difference", "--out", sequence_.path("live.html")});
  EXPECT_NE(alone.exit_code, 0);
  EXPECT_THAT(alone.err, HasSubstr("--interactive"));
}

TEST_F(LiveReport, WithoutItsSequenceHasPathsAndFigures) {
  std::filesystem::remove_all(sequence_.path("rgb"));
  const CliResult made = report("live.html");
  ASSERT_EQ(made.exit_code, 0) << made.err;
  const nlohmann::json sequence = page_data(page("live.html")).at("sequences").at(0);
  EXPECT_EQ(sequence.at("pictures").at("frames").size(), 0U);
  EXPECT_THAT(sequence.at("pictures").at("told").get<std::string>(), HasSubstr("No pictures: "));
  EXPECT_FALSE(sequence.at("runs").at(0).at("positions").at(3).is_null());
}

TEST(LiveReportNames, AreNoMarkupAndBreakNothing) {
  const SmallSequence sequence(4);
  const std::string odd = sequence.path() + "_<!--<script>'\"&\\u003c\xff\xe2\x80\xa8";
  std::filesystem::copy(sequence.path(), odd, std::filesystem::copy_options::recursive);
  const TemporaryFolder out("out");
  const CliResult ran = run_cli({"run", odd, "--method", "none", "--out", out.path("run")});
  ASSERT_EQ(ran.exit_code, 0) << ran.err;
  const CliResult made = run_cli({"report", out.path("run"), "--interactive", "--out", out.path("r.html")});
  ASSERT_EQ(made.exit_code, 0) << made.err;
  const std::string html = out.read("r.html");
  EXPECT_EQ(html.find("<!--"), std::string::npos);
  const std::string name = page_data(html).at("sequences").at(0).at("name");
  EXPECT_THAT(name, HasSubstr("_<!--<script>'\"&\\u003c\xef\xbf\xbd"));  // U+FFFD for what is no UTF-8
}

TEST(ScriptJson, KeepsEveryTextAndEndsNoScript) {
  const std::vector<std::string> texts = {"</script><script>alert(1)", "<!-- <script>",
                                          "\"quotes\" and \\ and '",   std::string("\0\n\r\t", 4),
                                          "\u2028\u2029 ]]>",          "\xc3\xa9 ä"};
  const std::string text = script_json(nlohmann::ordered_json(texts));
  for (const char* part : {"<", "\n", "\xe2\x80\xa8"}) EXPECT_THAT(text, Not(HasSubstr(part)));
  EXPECT_EQ(nlohmann::json::parse(text), nlohmann::json(texts));
  EXPECT_EQ(nlohmann::json::parse(script_json(nlohmann::ordered_json("a\xff\xfe z"))),
            "a\xef\xbf\xbd\xef\xbf\xbd z");
  EXPECT_EQ(script_json(nlohmann::ordered_json(std::nan(""))), "null");
}

}  // namespace
}  // namespace stillpoint
