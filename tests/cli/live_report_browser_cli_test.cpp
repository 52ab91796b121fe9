// How an interactive report behaves in a browser, where Chromium is installed.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include "tests/cli/live_report_example.hpp"
#include "tests/cli/run_cli.hpp"
#include "tests/support/places.hpp"

namespace stillpoint {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

using LiveReportInABrowser = LiveReportExample;

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

TEST_F(LiveReportInABrowser, GoesAbout) {
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
