// Every panel and the whole workbench against images kept in the repository. tests/update_golden writes them
// anew.
#include "tests/support/golden.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/run/removal_errors.hpp"
#include "core/run/saved_map.hpp"
#include "core/run/sweep.hpp"
#include "tests/ui/session_example.hpp"
#include "ui/panels/panel.hpp"
#include "ui/shell/offscreen.hpp"
#include "ui/workbench/workbench.hpp"

namespace stillpoint::testing {
namespace {

using ::testing::IsEmpty;

/// px, of a panel's image: as small as it may be with everything in it.
constexpr int kPanelWidth = 440, kPanelHeight = 350;
constexpr int kWholeWidth = 1200, kWholeHeight = 760;

/// The panel draws in three dimensions, where drivers may differ more.
bool has_scene(const std::string& panel) { return panel == "trajectory"; }

/// Panels take turns in the two themes.
Look look_of(std::size_t place) { return {place % 2 == 0 ? ThemeName::kDark : ThemeName::kLight, 0.8F}; }

/// What is there for a person to do, so that nothing is greyed out.
WorkbenchHost idle_host() {
  return {.go_to_frame = [](int) {},
          .play = [](bool) {},
          .speed = [](double) {},
          .open = [](const std::string&) {},
          .request = [](const SessionRequest&) {}};
}

class GoldenPanel : public ::testing::TestWithParam<std::size_t> {};

TEST_P(GoldenPanel, LooksAsItDid) {
  Offscreen offscreen({.width = kPanelWidth, .height = kPanelHeight, .look = look_of(GetParam())});
  const auto panels = make_panels();  // what they draw with is let go of before the context goes
  Panel& panel = *panels[GetParam()];
  const SessionView example = handmade_example();
  const cv::Mat image =
      offscreen.render([&](UiFrame& frame) { Workbench::draw_alone(frame, example, panel); });
  // Below the heading, whose letters are no content.
  EXPECT_FALSE(is_blank(image(cv::Rect(8, 32, kPanelWidth - 16, kPanelHeight - 40)), 20)) << panel.name();
  EXPECT_TRUE(matches_golden(image, "panel_" + panel.name(),
                             has_scene(panel.name()) ? kSceneTolerance : kInterfaceTolerance));
  EXPECT_THAT(offscreen.take_gl_errors(), IsEmpty());
  offscreen.make_current();
}

INSTANTIATE_TEST_SUITE_P(Panels, GoldenPanel, ::testing::Range<std::size_t>(0, panel_names().size()),
                         [](const auto& one) { return panel_names()[one.param]; });

/// The whole workbench, in the layout a newcomer sees.
class GoldenWorkbench : public ::testing::Test {
 protected:
  ~GoldenWorkbench() override { offscreen_.make_current(); }

  cv::Mat render(const Look& look, const SessionView* session) {
    offscreen_.set_look(look);
    return offscreen_.render([&](UiFrame& frame) { workbench_.draw(frame, session); });
  }
  void expect_golden(const std::string& name, const Look& look, const SessionView* session,
                     bool shows_scene = false) {
    const cv::Mat image = render(look, session);
    EXPECT_FALSE(is_blank(image, 50)) << name;
    // Drivers may differ in the one tile that draws in three dimensions, and nowhere else.
    const auto tile = session != nullptr ? workbench_.tile_of("trajectory") : std::nullopt;
    if (tile) {
      const cv::Rect scene(static_cast<int>(tile->x), static_cast<int>(tile->y),
                           static_cast<int>(tile->width), static_cast<int>(tile->height));
      EXPECT_TRUE(matches_golden_but_scene(image, name, scene));
    } else {
      EXPECT_TRUE(matches_golden(image, name, kInterfaceTolerance));
    }
    EXPECT_EQ(tile.has_value(), shows_scene) << name;
    EXPECT_THAT(offscreen_.take_gl_errors(), IsEmpty());
  }

  Offscreen offscreen_{{.width = kWholeWidth, .height = kWholeHeight}};
  Workbench workbench_{make_panels(), idle_host()};
  SessionView example_ = handmade_example();
};

constexpr Look kDark{ThemeName::kDark, 0.8F}, kLight{ThemeName::kLight, 0.8F};

TEST(GoldenTolerance, IsLooserInTheSceneAlone) {
  const cv::Rect scene(100, 100, 200, 200);  // 0.05 % of it are 20 px
  const cv::Mat expected(400, 400, CV_8UC3, cv::Scalar::all(0));
  const auto agrees_with = [&](const cv::Rect& changed) {
    cv::Mat actual = expected.clone();
    actual(changed).setTo(cv::Scalar::all(3));
    return static_cast<bool>(images_agree_but_scene(actual, expected, scene));
  };
  EXPECT_TRUE(agrees_with({0, 0, 10, 1}));
  EXPECT_FALSE(agrees_with({0, 0, 11, 1}));
  EXPECT_TRUE(agrees_with({150, 150, 20, 1}));
  EXPECT_FALSE(agrees_with({150, 150, 21, 1}));
  EXPECT_FALSE(images_agree_but_scene(expected, expected, cv::Rect(500, 0, 9, 9))) << "no scene there";
}

TEST_F(GoldenWorkbench, Dark) {
  workbench_.set_layout(default_layout("stillpoint"));
  expect_golden("workbench_dark", kDark, &example_, true);
}

TEST_F(GoldenWorkbench, Light) {
  workbench_.set_layout(default_layout("paper"));
  expect_golden("workbench_light", kLight, &example_, true);
}

TEST_F(GoldenWorkbench, StartPage) {
  workbench_.set_recent({"/home/someone/rgbd_dataset_freiburg3_walking_xyz", "generated:walking_static"});
  expect_golden("workbench_start", kLight, nullptr);
}

TEST_F(GoldenWorkbench, Keys) {
  render(kDark, &example_);
  workbench_.actions().run("shortcuts");
  expect_golden("workbench_keys", kDark, nullptr);
}

TEST_F(GoldenWorkbench, Palette) {
  workbench_.set_layout({.panel = "input"});
  render(kLight, &example_);
  workbench_.actions().run("palette");
  offscreen_.draw([&](UiFrame& frame) { workbench_.draw(frame, &example_); });
  for (const char letter : std::string("ste")) offscreen_.send(TextTyped{static_cast<unsigned>(letter)});
  expect_golden("workbench_palette", kLight, &example_);
}

TEST_F(GoldenWorkbench, ErrorAndOpening) {
  render(kDark, nullptr);
  workbench_.set_opening("/home/someone/rgbd_dataset_freiburg3_walking_xyz");
  workbench_.say("/home/someone/pictures: holds neither rgb.txt nor a folder of colour frames.", true);
  expect_golden("workbench_notices", kDark, nullptr);
}

}  // namespace
}  // namespace stillpoint::testing
