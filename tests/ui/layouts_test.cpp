// Every layout at the sizes windows have.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "core/check/findings.hpp"
#include "core/inspect/frame_view.hpp"
#include "core/inspect/run_view.hpp"
#include "core/odometry/frame_record.hpp"
#include "core/run/removal_errors.hpp"
#include "core/run/saved_map.hpp"
#include "core/run/sweep.hpp"
#include "tests/support/golden.hpp"
#include "tests/ui/session_example.hpp"
#include "ui/panels/panel.hpp"
#include "ui/shell/offscreen.hpp"
#include "ui/workbench/workbench.hpp"

namespace stillpoint::testing {
namespace {

using ::testing::Contains;
using ::testing::IsEmpty;
using ::testing::Not;

struct WindowSize {
  int width, height;
  float scale;
};

constexpr WindowSize kWindowSizes[] = {{1280, 720, 1.0F},  {1600, 900, 1.0F}, {900, 700, 1.0F},
                                       {640, 480, 1.0F},   {700, 1100, 1.0F}, {3840, 2160, 2.0F},
                                       {1800, 1400, 2.0F}, {1280, 720, 1.5F}};

std::map<std::string, PanelSize> least_sizes() {
  std::map<std::string, PanelSize> least;
  for (const auto& panel : make_panels()) least[panel->name()] = panel->least();
  return least;
}

bool overlap(const LayoutRect& a, const LayoutRect& b) {
  return a.x < b.x + b.width && b.x < a.x + a.width && a.y < b.y + b.height && b.y < a.y + a.height;
}

class LayoutsTest : public ::testing::Test {
 protected:
  ~LayoutsTest() override { offscreen_.make_current(); }

  void show(const NamedLayout& layout, const WindowSize& size, const std::string& method = "stillpoint") {
    offscreen_.resize(size.width, size.height);
    offscreen_.set_look({ThemeName::kDark, size.scale});
    workbench_.set_layout(layout.make(method));
    draw();
  }
  void draw() {
    offscreen_.draw([&](UiFrame& frame) { workbench_.draw(frame, &example_); });
  }
  void expect_golden(std::string_view layout, const WindowSize& size) {
    for (const NamedLayout& one : named_layouts())
      if (one.name == layout) show(one, size);
    const cv::Mat image = offscreen_.render([&](UiFrame& frame) { workbench_.draw(frame, &example_); });
    const std::string name = fmt::format("layout_{}_{}x{}", layout, size.width, size.height);
    const auto tile = workbench_.tile_of("trajectory");
    if (!tile) {
      EXPECT_TRUE(matches_golden(image, name));
      return;
    }
    // Drivers may differ in the one tile that draws in three dimensions.
    const cv::Rect scene(static_cast<int>(tile->x), static_cast<int>(tile->y), static_cast<int>(tile->width),
                         static_cast<int>(tile->height));
    EXPECT_TRUE(matches_golden_but_scene(image, name, scene));
  }

  SessionView example_ = debug_example();
  Offscreen offscreen_{{.width = 1280, .height = 720}};
  Workbench workbench_{make_panels()};
};

TEST_F(LayoutsTest, NoTileIsTooSmallToBeRead) {
  const auto least = least_sizes();
  for (const WindowSize& size : kWindowSizes)
    for (const NamedLayout& layout : named_layouts())
      for (const std::string method : {"stillpoint", "paper"}) {
        SCOPED_TRACE(
            fmt::format("{} of {} at {}x{}, {}", layout.name, method, size.width, size.height, size.scale));
        show(layout, size, method);
        std::vector<LayoutRect> seen;
        std::set<std::string> reachable;
        for (const PlacedPanel& place : workbench_.places()) {
          reachable.insert(place.panel);
          reachable.insert(place.tabs.begin(), place.tabs.end());
          const PanelSize wanted = least.at(place.panel);
          EXPECT_GE(place.rect.width + 1.0F, wanted.width * size.scale) << place.panel;
          EXPECT_GE(place.rect.height + 1.0F, wanted.height * size.scale) << place.panel;
          EXPECT_GE(place.rect.x, 0.0F);
          EXPECT_LE(place.rect.x + place.rect.width, static_cast<float>(size.width));
          EXPECT_LE(place.rect.y + place.rect.height, static_cast<float>(size.height));
          for (const LayoutRect& other : seen) EXPECT_FALSE(overlap(place.rect, other)) << place.panel;
          seen.push_back(place.rect);
        }
        // What is not seen is behind a tab: nothing is gone.
        EXPECT_EQ(reachable.size(), panels_of(workbench_.layout()).size());
      }
  EXPECT_THAT(offscreen_.take_gl_errors(), IsEmpty());
}

TEST_F(LayoutsTest, WideWindowsHaveNoTabs) {
  for (const WindowSize& size : {WindowSize{1920, 1080, 1.0F}, WindowSize{3840, 2160, 2.0F}})
    for (const NamedLayout& layout : named_layouts()) {
      show(layout, size);
      for (const PlacedPanel& place : workbench_.places()) EXPECT_THAT(place.tabs, IsEmpty()) << layout.name;
    }
}

TEST_F(LayoutsTest, ATabIsBroughtToTheFrontByItsNameByKeyAndByMenu) {
  show(named_layouts()[3], {900, 700, 1.0F});  // Failures
  const auto place_of = [&](const std::string& panel) {
    for (const PlacedPanel& place : workbench_.places())
      if (std::find(place.tabs.begin(), place.tabs.end(), panel) != place.tabs.end()) return place;
    return PlacedPanel{};
  };
  const PlacedPanel place = place_of("bookmarks");
  ASSERT_EQ(place.panel, "breakpoints");
  EXPECT_FALSE(workbench_.tile_of("bookmarks"));
  // Its name stands after the first one's.
  offscreen_.send(MouseMoved{place.rect.x + 130.0F, place.rect.y + 12.0F});
  draw();
  offscreen_.send(MouseButton{0, true, {}});
  draw();
  offscreen_.send(MouseButton{0, false, {}});
  draw();
  draw();
  EXPECT_TRUE(workbench_.tile_of("bookmarks"));
  EXPECT_FALSE(workbench_.tile_of("breakpoints"));
  EXPECT_TRUE(workbench_.actions().run("next_tab"));
  draw();
  draw();
  EXPECT_TRUE(workbench_.tile_of("breakpoints"));
  // What is behind a tab is shown, not taken out.
  EXPECT_TRUE(workbench_.actions().run("panel.bookmarks"));
  draw();
  draw();
  EXPECT_TRUE(workbench_.tile_of("bookmarks"));
  EXPECT_TRUE(workbench_.actions().run("panel.bookmarks"));
  draw();
  EXPECT_THAT(panels_of(workbench_.layout()), Not(Contains("bookmarks")));
}

TEST_F(LayoutsTest, TheTabThatWasSeenIsSeenAgain) {
  show(named_layouts()[3], {900, 700, 1.0F});  // Failures
  ASSERT_TRUE(workbench_.tile_of("breakpoints"));
  EXPECT_TRUE(workbench_.actions().run("panel.bookmarks"));
  draw();
  draw();
  ASSERT_TRUE(workbench_.tile_of("bookmarks"));
  const std::string kept = to_json(workbench_.layout());
  Workbench again(make_panels());
  again.set_layout(parse_layout(kept, "kept", again.panel_names()));
  for (int i = 0; i < 2; ++i) offscreen_.draw([&](UiFrame& frame) { again.draw(frame, &example_); });
  EXPECT_TRUE(again.tile_of("bookmarks"));
  EXPECT_FALSE(again.tile_of("breakpoints"));
  offscreen_.make_current();
}

TEST_F(LayoutsTest, ALegendThatWouldCoverThePathsStandsBelow) {
  workbench_.set_layout({.panel = "trajectory"});
  const auto upper_left = [&](int height) {
    offscreen_.resize(640, height);
    draw();
    const cv::Mat image = offscreen_.render([&](UiFrame& frame) { workbench_.draw(frame, &example_); });
    const auto tile = workbench_.tile_of("trajectory");
    // Below the controls, where the names of the paths stand in a large tile: how much is as bright as text.
    cv::Mat bright;
    const cv::Rect there(static_cast<int>(tile->x) + 44, static_cast<int>(tile->y) + 72, 70, 30);
    cv::inRange(image(there), cv::Scalar(160, 160, 160), cv::Scalar(255, 255, 255), bright);
    return cv::countNonZero(bright);
  };
  EXPECT_GT(upper_left(720), 35);
  EXPECT_LT(upper_left(330), 20);
  // With no room below either, it is over the picture rather than nowhere.
  EXPECT_GT(upper_left(240), 35);
}

TEST_F(LayoutsTest, APanelBroughtUpIsSeenWhereverThereIsRoom) {
  for (const std::string& panel : panel_names()) {
    show(named_layouts()[0], {900, 700, 1.0F});
    if (workbench_.tile_of(panel)) continue;
    workbench_.actions().run("panel." + panel);
    draw();
    draw();
    EXPECT_TRUE(workbench_.tile_of(panel)) << panel;
  }
}

TEST_F(LayoutsTest, RowsOfTheTimelineThatHaveNoRoomAreScrolledTo) {
  workbench_.set_layout({.panel = "timeline"});
  offscreen_.resize(900, 300);
  const cv::Mat before = offscreen_.render([&](UiFrame& frame) { workbench_.draw(frame, &example_); });
  const auto tile = workbench_.tile_of("timeline");
  ASSERT_TRUE(tile);
  offscreen_.send(MouseMoved{tile->x + 0.4F * tile->width, tile->y + 0.5F * tile->height});
  draw();
  for (int i = 0; i < 3; ++i) offscreen_.send(MouseWheel{0.0F, -1.0F, {.shift = true}});
  draw();
  offscreen_.send(MouseMoved{10.0F, 10.0F});
  draw();
  const cv::Mat after = offscreen_.render([&](UiFrame& frame) { workbench_.draw(frame, &example_); });
  // Names of rows at the left are others now, and what stands above them is as it was.
  const cv::Rect names(static_cast<int>(tile->x) + 10, static_cast<int>(tile->y) + 110, 90, 60);
  EXPECT_GT(cv::norm(before(names), after(names), cv::NORM_INF), 50.0);
  const cv::Rect head(static_cast<int>(tile->x) + 10, static_cast<int>(tile->y) + 55, 90, 20);
  EXPECT_EQ(cv::norm(before(head), after(head), cv::NORM_INF), 0.0);
}

TEST_F(LayoutsTest, NarrowWindowsLookAsTheyDid) { expect_golden("failures", {900, 700, 1.0F}); }
TEST_F(LayoutsTest, SmallWindowsLookAsTheyDid) { expect_golden("motion", {1280, 720, 1.0F}); }
TEST_F(LayoutsTest, FineDisplaysLookAsTheyDid) {
  for (const NamedLayout& layout : named_layouts()) expect_golden(layout.name, {1800, 1400, 2.0F});
}

}  // namespace
}  // namespace stillpoint::testing
