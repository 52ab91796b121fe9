// Interactive reports: one page, whatever names, lost frames and room there are; and how it behaves in a
// browser where Chromium is installed.
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
#include "tests/cli/run_cli.hpp"
#include "tests/cli/small_sequence.hpp"
#include "tests/support/places.hpp"

namespace stillpoint {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

/// What stands between two texts, the first time; empty where they do not.
std::string between(const std::string& text, const std::string& before, const std::string& after) {
  const std::size_t from = text.find(before);
  if (from == std::string::npos) return {};
  const std::size_t begin = from + before.size(), end = text.find(after, begin);
  return end == std::string::npos ? std::string() : text.substr(begin, end - begin);
}

nlohmann::json page_data(const std::string& html) {
  const std::string text =
      between(html, "<script type=\"application/json\" id=\"report-data\">", "</script>");
  EXPECT_TRUE(nlohmann::json::accept(text));
  return nlohmann::json::parse(text, nullptr, false);
}

/// A square that a mask made elsewhere takes for dynamic, in every frame but the first.
void write_masks(const SmallSequence& sequence, int frames) {
  for (int i = 1; i < frames; ++i) {
    cv::Mat mask(SmallSequence::kHeight, SmallSequence::kWidth, CV_8UC1, cv::Scalar(0));
    mask(cv::Rect(40 + 4 * i, 60, 80, 80)).setTo(255);
    sequence.folder.write(fmt::format("masks/{}.png", i), mask);
  }
}

class LiveReport : public ::testing::Test {
 protected:
  static constexpr int kFrames = 10, kUnreadable = 6;

  LiveReport() {
    write_masks(sequence_, kFrames);
    sequence_.folder.write(SmallSequence::colour(kUnreadable), std::string("no image"));
    for (const char* method : {"none", "stillpoint"}) {
      std::vector<std::string> arguments = {"run",  sequence_.path(), "--method",
                                            method, "--out",          run(method)};
      if (method != std::string("none"))
        arguments.insert(arguments.end(), {"--masks", sequence_.path("masks/")});
      const CliResult ran = run_cli(arguments);
      EXPECT_EQ(ran.exit_code, 0) << ran.err;
    }
  }

  [[nodiscard]] std::string run(const std::string& method) const { return sequence_.path("runs/" + method); }
  [[nodiscard]] CliResult report(const std::string& name, const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments = {"report",  run("none"), run("stillpoint"), "--interactive",
                                          "--worst", "1",         "--out",           sequence_.path(name)};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_cli(arguments);
  }
  [[nodiscard]] std::string page(const std::string& name) const { return sequence_.folder.read(name); }

  SmallSequence sequence_{kFrames};
};

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

/// Chromium on a page, without a display. @returns what it wrote
std::string browse(const std::vector<std::string>& more, const std::string& address) {
  const TemporaryFolder profile("profile");
  std::vector<std::string> arguments = {"timeout",
                                        "90",
                                        "chromium",
                                        "--headless",
                                        "--no-sandbox",
                                        "--disable-gpu",
                                        "--no-first-run",
                                        "--disable-dev-shm-usage",
                                        "--hide-scrollbars",
                                        "--virtual-time-budget=8000",
                                        "--user-data-dir=" + profile.path()};
  arguments.insert(arguments.end(), more.begin(), more.end());
  arguments.push_back("file://" + address);
  return CliProcess(arguments, "/usr/bin/env").wait().out;
}

/// Goes about as a person would, and leaves what it found at the page's end.
constexpr const char* kVisit = R"js(<script>
(async () => {
  const page = window.stillpointReport, found = {}, $ = (s) => document.querySelector(s);
  const breath = () => new Promise((done) => setTimeout(done, 150));
  // Pictures are decoded beside: on a busy machine that takes longer than a breath.
  const until = async (holds) => { for (let k = 0; k < 40 && !holds(); ++k) await breath(); };
  const press = (key, more = {}) => document.body.dispatchEvent(new KeyboardEvent("keydown", {key, bubbles: true, ...more}));
  const click = (canvas, [x, y]) => {
    const box = canvas.getBoundingClientRect();
    for (const type of ["pointerdown", "pointerup"])
      canvas.dispatchEvent(new PointerEvent(type, {pointerId: 7, button: 0, bubbles: true, clientX: box.left + canvas.clientLeft + x, clientY: box.top + canvas.clientTop + y}));
  };
  const ink = (canvas) => {
    const {data} = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
    let count = 0;
    for (let i = 3; i < data.length; i += 4) count += data[i] > 0;
    return count / (canvas.width * canvas.height);
  };
  await until(() => $("#picture").dataset.frame === "5");
  found.linked = page.frame;
  found.linkedRun = page.run;
  found.where = $("#where").textContent;
  found.legend = $("#plots .legend").textContent;
  found.picture = Number($("#picture").dataset.frame);
  found.poses = [...document.querySelectorAll("#poses strong")].map((name) => name.textContent);
  found.poseLegends = [...document.querySelectorAll("#poses .legend")].map((legend) => legend.textContent);
  found.poseInks = [...document.querySelectorAll("#poses canvas")].map(ink);
  found.pathsNote = $("#paths-note").textContent;
  found.pathsLegend = $("#paths-legend").textContent;
  found.inkedPaths = ink($("#paths"));
  found.inked = {orbit: ink($("#orbit")), picture: ink($("#picture")), plot: ink($("#plots canvas"))};
  press("ArrowRight"); found.right = page.frame;
  press("ArrowLeft", {shiftKey: true}); found.tenBack = page.frame;
  press("ArrowRight", {shiftKey: true}); found.tenOn = page.frame;
  $("#slider").value = 6; $("#slider").dispatchEvent(new Event("input"));
  await until(() => $("#picture-note").textContent.includes("Frame 6"));
  found.lost = $("#where").textContent;
  found.lostMarked = $("#where").classList.contains("lost");
  found.note = $("#picture-note").textContent;
  found.dash = $("#plots .legend").textContent;
  const drag = (canvas, dx, dy, more = {}) => {
    const box = canvas.getBoundingClientRect(), at = {pointerId: 8, bubbles: true, buttons: 1, clientX: box.left + 100, clientY: box.top + 100, ...more};
    canvas.dispatchEvent(new PointerEvent("pointerdown", at));
    canvas.dispatchEvent(new PointerEvent("pointermove", {...at, clientX: at.clientX + dx, clientY: at.clientY + dy}));
    canvas.dispatchEvent(new PointerEvent("pointerup", {...at, clientX: at.clientX + dx, clientY: at.clientY + dy}));
  };
  const seen = () => { const a = page.screenOf(1, 0), b = page.screenOf(1, 9); return [a[0], a[1], Math.hypot(a[0] - b[0], a[1] - b[1]), b[0] - a[0], b[1] - a[1]]; };
  const start = seen();
  drag($("#orbit"), 30, 20, {shiftKey: true});
  const moved = seen();
  found.moved = [moved[0] - start[0], moved[1] - start[1]];
  $("#orbit").dispatchEvent(new WheelEvent("wheel", {deltaY: -400, cancelable: true}));
  found.zoomed = seen()[2] / start[2];
  const before3d = seen();
  drag($("#orbit"), 200, 0);
  const after3d = seen();
  found.turned = Math.hypot(after3d[3] - before3d[3], after3d[4] - before3d[4]) / before3d[2];
  $("#orbit").dispatchEvent(new MouseEvent("dblclick"));
  click($("#orbit"), page.screenOf(1, 2)); found.path = [page.run, page.frame];
  click($("#paths"), page.pathScreenOf(1, 7)); found.flatPath = [page.run, page.frame];
  click($("#poses canvas"), [$("#poses canvas").clientWidth - 13, 60]); found.poseEnd = page.frame;
  $("#frames tr[data-frame='8']").cells[1].click(); found.row = page.frame;
  const inliers = [...document.querySelectorAll("#frames th")].findIndex((th) => th.textContent.startsWith("Inliers"));
  const column = () => [...document.querySelectorAll("#frames tr[data-frame]")].map((row) => row.cells[inliers].textContent);
  document.querySelectorAll("#frames th button")[inliers].click();
  found.sorted = column();
  found.ariaSort = document.querySelectorAll("#frames th")[inliers].getAttribute("aria-sort");
  document.querySelectorAll("#frames th button")[inliers].click();
  found.sortedBack = column();
  const canvas = $("#plots canvas");
  click(canvas, [canvas.clientWidth - 13, 60]); found.plotEnd = page.frame;
  window.scrollTo(0, document.body.scrollHeight);
  location.hash = "#frame=4"; await breath(); found.hash = page.frame;
  found.inSight = $("#live").getBoundingClientRect().bottom > 0;
  location.hash = "#frame=999999"; await breath(); found.beyond = page.frame;
  await new Promise((done) => setTimeout(done, 500)); found.address = location.hash;
  press("Home"); press(" "); found.playing = $("#play").textContent;
  await new Promise((done) => setTimeout(done, 1000)); found.played = page.frame;
  const before = [...document.querySelectorAll("div.scroll table")][0].tBodies[0].textContent;
  [...document.querySelectorAll("div.scroll table")][0].querySelector("th button").click();
  [...document.querySelectorAll("div.scroll table")][0].querySelector("th button").click();
  found.summaryTurned = before !== [...document.querySelectorAll("div.scroll table")][0].tBodies[0].textContent;
  const told = document.createElement("pre");
  told.id = "found";
  told.textContent = JSON.stringify(found);
  document.body.append(told);
})();
</script>)js";

TEST_F(LiveReport, GoesAboutInABrowser) {
  if (std::system("chromium --version >/dev/null 2>&1") != 0) GTEST_SKIP() << "chromium is not installed";
  ASSERT_EQ(report("live.html").exit_code, 0);
  std::string html = page("live.html");
  html.insert(html.rfind("</body>"), kVisit);
  sequence_.folder.write("visited.html", html);
  const std::string dom = browse({"--dump-dom"}, sequence_.path("visited.html") + "#frame=5&run=2");
  const auto found = nlohmann::json::parse(between(dom, "<pre id=\"found\">", "</pre>"), nullptr, false);
  ASSERT_TRUE(found.is_object()) << dom.substr(dom.size() - std::min<std::size_t>(dom.size(), 2000));
  EXPECT_EQ(found.at("linked"), 5);
  EXPECT_EQ(found.at("linkedRun"), 1);
  EXPECT_EQ(found.at("where"), "Frame 5 · 0.17 s · tracked");
  EXPECT_EQ(found.at("picture"), 5);
  EXPECT_GT(found.at("inked").at("orbit"), 0.001);
  EXPECT_GT(found.at("inked").at("picture"), 0.99);
  EXPECT_GT(found.at("inked").at("plot"), 0.005);
  EXPECT_EQ(found.at("right"), 6);
  EXPECT_EQ(found.at("tenBack"), 0);
  EXPECT_EQ(found.at("tenOn"), 9);
  EXPECT_THAT(found.at("lost").get<std::string>(), HasSubstr("Frame 6 · 0.20 s · unreadable"));
  EXPECT_EQ(found.at("lostMarked"), true);
  EXPECT_THAT(found.at("note").get<std::string>(), HasSubstr("Frame 6 has no picture; this is frame 5."));
  EXPECT_EQ(found.at("dash"), "none –stillpoint –");
  EXPECT_THAT(found.at("legend").get<std::string>(), Not(HasSubstr("NaN")));
  // The scene follows the mouse: what is nearer than the middle farther. Nearer it is larger; turned, the way
  // points elsewhere.
  const double right = found.at("moved").at(0), down = found.at("moved").at(1);
  EXPECT_NEAR(right / down, 30.0 / 20.0, 0.02);
  EXPECT_NEAR(right, 30.0, 15.0);
  EXPECT_GT(found.at("zoomed"), 1.3);
  EXPECT_GT(found.at("turned"), 0.3);
  EXPECT_EQ(found.at("path"), nlohmann::json({1, 2}));
  // As the plain report has them: all paths in one scale, and each number of the poses over time.
  EXPECT_EQ(found.at("flatPath"), nlohmann::json({1, 7}));
  EXPECT_EQ(found.at("poseEnd"), 9);
  EXPECT_GT(found.at("inkedPaths"), 0.005);
  EXPECT_EQ(found.at("pathsLegend"), "ground truthnonestillpoint");
  EXPECT_THAT(found.at("pathsNote").get<std::string>(), HasSubstr("All runs in one scale, along x and "));
  const std::vector<std::string> poses = found.at("poses");
  EXPECT_EQ(poses, (std::vector<std::string>{"Position x, m", "Position y, m", "Position z, m",
                                             "Angle roll, °", "Angle pitch, °", "Angle yaw, °"}));
  for (const double inked : found.at("poseInks")) EXPECT_GT(inked, 0.005);
  // The truth goes 2 px a frame along x, and does not turn.
  const std::vector<std::string> numbers = found.at("poseLegends");
  EXPECT_THAT(numbers.at(0),
              ::testing::StartsWith(fmt::format("ground truth {:.3f}none ",
                                                5 * 2 * SmallSequence::kDepth / SmallSequence::kFocal)));
  EXPECT_THAT(numbers.at(5), ::testing::StartsWith("ground truth 0.00none "));
  EXPECT_EQ(found.at("row"), 8);
  EXPECT_EQ(found.at("ariaSort"), "ascending");  // few inliers are the bad ones
  for (const char* list : {"sorted", "sortedBack"}) {
    const std::vector<std::string> column = found.at(list);
    ASSERT_EQ(column.size(), static_cast<std::size_t>(kFrames));
    EXPECT_EQ(column.back(), "–") << list;  // what is not known comes last either way
    const int sign = list == std::string("sorted") ? 1 : -1;
    for (std::size_t i = 2; i < column.size(); ++i)
      if (column[i] != "–") {
        EXPECT_LE(sign * std::stoi(column[i - 1]), sign * std::stoi(column[i])) << list;
      }
  }
  EXPECT_EQ(found.at("plotEnd"), 9);
  EXPECT_EQ(found.at("hash"), 4);
  EXPECT_EQ(found.at("inSight"), true);
  EXPECT_EQ(found.at("beyond"), 9);
  EXPECT_EQ(found.at("address"), "#frame=9&amp;run=2");  // as markup has it
  EXPECT_EQ(found.at("playing"), "Pause");
  EXPECT_GT(found.at("played"), 2);
  EXPECT_EQ(found.at("summaryTurned"), true);

  const std::string shot = places::output() + "/live_report.png";
  std::filesystem::create_directories(places::output());
  browse({"--window-size=1280,1700", "--screenshot=" + shot}, sequence_.path("live.html") + "#frame=5&run=2");
  const cv::Mat image = cv::imread(shot);
  ASSERT_EQ(image.size(), cv::Size(1280, 1700));
  cv::Scalar mean, deviation;
  cv::meanStdDev(image, mean, deviation);
  EXPECT_GT(deviation[0], 10.0);
}

}  // namespace
}  // namespace stillpoint
