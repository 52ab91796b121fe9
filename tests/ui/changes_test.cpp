// What a frame of the interface draws where only some of it has changed since the one before.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <imgui.h>

#include <algorithm>
#include <array>

#include "core/run/removal_errors.hpp"
#include "core/run/sweep.hpp"
#include "ui/gl/changed_regions.hpp"
#include "ui/panels/panel.hpp"
#include "ui/session/session.hpp"
#include "ui/shell/offscreen.hpp"
#include "ui/theme/fonts.hpp"
#include "ui/workbench/workbench.hpp"

namespace stillpoint::testing {
namespace {

using ::testing::IsEmpty;

constexpr int kChangesWidth = 1100, kChangesHeight = 700;

/// A short session's views, frame by frame.
const std::vector<std::shared_ptr<const SessionView>>& views() {
  static const auto all = [] {
    OpenOptions short_one;
    short_one.frames = 5;
    Config config;
    config.run.method = "stillpoint";
    Session session(open_sequence("generated:walking_static", short_one), config, {.keep_times = false});
    std::vector<std::shared_ptr<const SessionView>> made;
    for (int frame = 0; frame < short_one.frames; ++frame) {
      session.go_to(frame);
      made.push_back(session.view());
    }
    return made;
  }();
  return all;
}

cv::Mat drawn_afresh(const SessionView& view) {
  Offscreen offscreen({.width = kChangesWidth, .height = kChangesHeight});
  Workbench workbench(make_panels());
  cv::Mat image = offscreen.render([&](UiFrame& frame) { workbench.draw(frame, &view); });
  offscreen.make_current();
  return image;
}

int differing_pixels(const cv::Mat& a, const cv::Mat& b) {
  cv::Mat difference;
  cv::absdiff(a, b, difference);
  return cv::countNonZero(difference.reshape(1));
}

TEST(ChangesTest, APictureDrawnOnIsOneDrawnAfresh) {
  Offscreen offscreen({.width = kChangesWidth, .height = kChangesHeight});
  Workbench workbench(make_panels());
  const auto draw_until_still = [&](const SessionView& view) {
    return offscreen.render([&](UiFrame& frame) { workbench.draw(frame, &view); });
  };
  for (const std::size_t frame : {std::size_t{1}, std::size_t{3}, std::size_t{4}, std::size_t{1}})
    EXPECT_EQ(differing_pixels(draw_until_still(*views()[frame]), drawn_afresh(*views()[frame])), 0) << frame;
  EXPECT_THAT(offscreen.take_gl_errors(), IsEmpty());
}

TEST(ChangesTest, NothingIsDrawnWhereNothingChanged) {
  Offscreen offscreen({.width = kChangesWidth, .height = kChangesHeight});
  Workbench workbench(make_panels());
  const auto draw = [&](const SessionView& view) {
    return offscreen.draw([&](UiFrame& frame) { workbench.draw(frame, &view); }).changed;
  };
  for (int i = 0; i < kSettlingFrames; ++i) draw(*views()[3]);
  EXPECT_FALSE(draw(*views()[3]));
  EXPECT_TRUE(draw(*views()[4]));
}

TEST(ChangesTest, TilesTakeToAnotherFrameInTurnAndEndLevel) {
  Offscreen offscreen({.width = kChangesWidth, .height = kChangesHeight});
  Workbench workbench(make_panels());
  const auto draw = [&](const std::shared_ptr<const SessionView>& view) {
    return offscreen.draw([&](UiFrame& frame) { workbench.draw_in_turn(frame, view); });
  };
  for (int i = 0; i < 12; ++i) draw(views()[3]);
  EXPECT_TRUE(workbench.is_level());
  const UiFrame first = draw(views()[4]);
  EXPECT_FALSE(workbench.is_level());
  EXPECT_TRUE(first.busy);
  EXPECT_EQ(first.redraw_after_s, 0.0);
  int frames = 1;
  for (; !workbench.is_level() && frames < 20; ++frames) draw(views()[4]);
  EXPECT_TRUE(workbench.is_level());
  EXPECT_LE(frames, 6);
  for (int i = 0; i < kSettlingFrames; ++i) draw(views()[4]);
  EXPECT_EQ(differing_pixels(offscreen.image(), drawn_afresh(*views()[4])), 0);
}

TEST(ChangesTest, WhilePlayingPicturesKeepUpAndPlotsFollowTenTimesASecond) {
  Offscreen offscreen({.width = kChangesWidth, .height = kChangesHeight});
  Workbench workbench(make_panels());
  const auto draw = [&](const std::shared_ptr<const SessionView>& view) {
    return offscreen.draw([&](UiFrame& frame) { workbench.draw_in_turn(frame, view); });
  };
  std::vector<std::shared_ptr<const SessionView>> played;
  for (std::size_t i = 1; i < views().size(); ++i) {
    auto view = std::make_shared<SessionView>(*views()[i]);
    view->playing = true;
    played.push_back(std::move(view));
  }
  for (int i = 0; i < 12; ++i) draw(views()[1]);
  const auto tile_in = [&](const cv::Mat& image, const char* panel) {
    const LayoutRect tile = workbench.tile_of(panel).value();
    return image(cv::Rect(static_cast<int>(tile.x), static_cast<int>(tile.y), static_cast<int>(tile.width),
                          static_cast<int>(tile.height)))
        .clone();
  };
  // Half a second of the interface's clock, another frame of the sequence with every fourth of its own.
  constexpr int kDrawn = 30, kEach = 4;
  int pictures = 0, plots = 0;
  cv::Mat before = offscreen.image();
  for (int i = 0; i < kDrawn; ++i) {
    draw(played[static_cast<std::size_t>(1 + i / kEach) % played.size()]);
    const cv::Mat now = offscreen.image();
    pictures += differing_pixels(tile_in(before, "features_before"), tile_in(now, "features_before")) > 0;
    plots += differing_pixels(tile_in(before, "timeline"), tile_in(now, "timeline")) > 0;
    before = now;
  }
  EXPECT_GE(pictures, 6) << "of the seven frames that came";
  EXPECT_GE(plots, 4);
  EXPECT_LE(plots, 6) << "ten times a second";
  // Where it stands still at last, all tiles show that frame and nothing of those before.
  for (int i = 0; i < 12; ++i) draw(views()[3]);
  EXPECT_TRUE(workbench.is_level());
  EXPECT_EQ(differing_pixels(offscreen.image(), drawn_afresh(*views()[3])), 0);
}

TEST(ChangesTest, TilesTakeToAnotherSequenceInTurn) {
  Offscreen offscreen({.width = kChangesWidth, .height = kChangesHeight});
  Workbench workbench(make_panels());
  const auto draw = [&](const std::shared_ptr<const SessionView>& view) {
    offscreen.draw([&](UiFrame& frame) { workbench.draw_in_turn(frame, view); });
    return offscreen.image();
  };
  const auto other = std::make_shared<SessionView>(*views()[2]);
  other->title = "another";
  for (const std::shared_ptr<const SessionView>& view :
       {views()[3], std::shared_ptr<const SessionView>(other)}) {
    draw(view);
    EXPECT_FALSE(workbench.is_level()) << "not all at once";
    int frames = 1;
    for (; !workbench.is_level() && frames < 20; ++frames) draw(view);
    EXPECT_TRUE(workbench.is_level());
    EXPECT_LE(frames, 7);
    for (int i = 0; i < kSettlingFrames; ++i) draw(view);
    EXPECT_EQ(differing_pixels(draw(view), drawn_afresh(*view)), 0);
  }
  // A panel that is added to what is shown does not wait.
  LayoutNode layout = workbench.layout();
  add_panel(layout, "pose", {0, 0, kChangesWidth, kChangesHeight});
  workbench.set_layout(layout);
  draw(other);
  EXPECT_TRUE(workbench.is_level());
}

TEST(ChangesTest, WhatNeedNotKeepUpSaysWhenItIsDrawnNext) {
  Offscreen offscreen({.width = kChangesWidth, .height = kChangesHeight});
  Workbench workbench(make_panels());
  LayoutNode alone;
  alone.panel = "timeline";
  workbench.set_layout(alone);
  const auto draw = [&](const std::shared_ptr<const SessionView>& view) {
    return offscreen.draw([&](UiFrame& frame) { workbench.draw_in_turn(frame, view); });
  };
  const auto playing = [](std::size_t frame) {
    auto view = std::make_shared<SessionView>(*views()[frame]);
    view->playing = true;
    return view;
  };
  for (int i = 0; i < 12; ++i) draw(views()[1]);
  draw(playing(2));
  EXPECT_TRUE(workbench.is_level()) << "it was not drawn for long";
  const auto next = playing(3);
  const UiFrame waiting = draw(next);
  EXPECT_FALSE(workbench.is_level());
  EXPECT_GT(waiting.redraw_after_s, 0.0);
  EXPECT_LE(waiting.redraw_after_s, 0.1);
  for (int i = 0; i < 6; ++i) draw(next);
  EXPECT_TRUE(workbench.is_level());
}

TEST(ChangesTest, AnImageIsShownBeforeItsOverlaysByTilesThatAreWorthIt) {
  Offscreen offscreen({.width = kChangesWidth, .height = kChangesHeight});
  Workbench workbench(make_panels());
  const auto draw = [&](const std::shared_ptr<const SessionView>& view) {
    for (int i = 0; i < 12; ++i) offscreen.draw([&](UiFrame& frame) { workbench.draw_in_turn(frame, view); });
    return offscreen.image();
  };
  const cv::Mat before = draw(views()[3]).clone();
  auto alone = std::make_shared<SessionView>(*views()[4]);
  auto image = std::make_shared<FrameView>();
  image->index = 4, image->frame = views()[4]->current->frame, image->image_alone = true;
  alone->current = image;
  const cv::Mat meanwhile = draw(alone).clone();
  EXPECT_TRUE(workbench.is_level()) << "there is nothing to wait for but the session";
  const auto changed = [&](const cv::Mat& a, const cv::Mat& b, const char* panel) {
    const LayoutRect tile = workbench.tile_of(panel).value();
    const cv::Rect area(static_cast<int>(tile.x) + 4, static_cast<int>(tile.y) + 32,
                        static_cast<int>(tile.width) - 8, static_cast<int>(tile.height) - 36);
    return cv::norm(a(area), b(area), cv::NORM_INF) > 0.0;
  };
  EXPECT_TRUE(changed(before, meanwhile, "features_before"));
  EXPECT_FALSE(changed(before, meanwhile, "motion")) << "stages stay until there are others";
  offscreen.draw([&](UiFrame& frame) { workbench.draw_in_turn(frame, views()[4]); });
  const cv::Mat first = offscreen.image();
  EXPECT_FALSE(changed(meanwhile, first, "features_before") && changed(meanwhile, first, "features_after"))
      << "overlays come in turn";
  const cv::Mat after = draw(views()[4]).clone();
  EXPECT_TRUE(changed(meanwhile, after, "motion"));
  EXPECT_EQ(differing_pixels(after, drawn_afresh(*views()[4])), 0);
}

/// Draw lists of rectangles, without a context that draws.
class DrawnRectangles {
 public:
  DrawnRectangles() : context_(ImGui::CreateContext()), list_(ImGui::GetDrawListSharedData()) {
    ImGui::GetIO().Fonts->AddFontDefault();
    ImGui::GetIO().Fonts->Build();
  }
  ~DrawnRectangles() { ImGui::DestroyContext(context_); }
  DrawnRectangles(const DrawnRectangles&) = delete;
  DrawnRectangles& operator=(const DrawnRectangles&) = delete;

  std::vector<PixelRect> changes(const std::vector<std::array<float, 4>>& rectangles,
                                 const std::vector<ImVec2>& curve = {}) {
    list_._ResetForNewFrame();
    list_.PushClipRect({0, 0}, {320, 320});
    for (const auto& r : rectangles) list_.AddRectFilled({r[0], r[1]}, {r[2], r[3]}, IM_COL32_WHITE);
    list_.AddPolyline(curve.data(), static_cast<int>(curve.size()), IM_COL32_WHITE, ImDrawFlags_None, 1.5F);
    ImDrawData data;
    std::array<ImDrawList*, 1> lists{&list_};
    data.CmdLists = lists.data();
    data.CmdListsCount = 1;
    data.DisplaySize = {320, 320};
    data.FramebufferScale = {1, 1};
    return regions_.update(data, 320, 320);
  }

 private:
  ImGuiContext* context_;
  ImDrawList list_;
  ChangedRegions regions_;
};

bool covers(const std::vector<PixelRect>& regions, int x, int y) {
  return std::any_of(regions.begin(), regions.end(),
                     [&](const PixelRect& r) { return r.x0 <= x && x < r.x1 && r.y0 <= y && y < r.y1; });
}

TEST(ChangesTest, ChangesAreWhereSomethingCameOrWent) {
  DrawnRectangles drawn;
  EXPECT_TRUE(covers(drawn.changes({{0, 0, 20, 20}}), 300, 300));  // the first time everywhere
  EXPECT_THAT(drawn.changes({{0, 0, 20, 20}}), IsEmpty());
  const auto moved = drawn.changes({{200, 100, 220, 120}});
  EXPECT_TRUE(covers(moved, 10, 10));
  EXPECT_TRUE(covers(moved, 210, 110));
  EXPECT_FALSE(covers(moved, 100, 300));
  // What lies over what counts, too.
  drawn.changes({{0, 0, 20, 20}, {10, 10, 30, 30}});
  EXPECT_TRUE(covers(drawn.changes({{10, 10, 30, 30}, {0, 0, 20, 20}}), 15, 15));
}

TEST(ChangesTest, AShapeIsTheSameWhereverItLiesInItsBuffers) {
  DrawnRectangles drawn;
  std::vector<ImVec2> curve;
  for (int i = 0; i < 60; ++i)
    curve.push_back({100.0F + 3.0F * static_cast<float>(i), 200.0F + static_cast<float>(i % 7)});
  drawn.changes({{0, 0, 20, 20}}, curve);
  for (const int more : {1, 2, 3}) {
    // What comes before it in the buffers, and there alone something changes.
    const std::vector<PixelRect> regions = drawn.changes(
        std::vector<std::array<float, 4>>(static_cast<std::size_t>(1 + more), {0, 0, 20, 20}), curve);
    EXPECT_TRUE(covers(regions, 10, 10)) << more;
    for (const ImVec2& point : curve)
      EXPECT_FALSE(covers(regions, static_cast<int>(point.x), static_cast<int>(point.y))) << more;
  }
  // Of a curve that has many points each counts.
  for (const std::size_t moved : {std::size_t{0}, std::size_t{17}, std::size_t{30}, curve.size() - 1}) {
    curve[moved].y += 0.25F;
    EXPECT_TRUE(covers(drawn.changes({{0, 0, 20, 20}}, curve), static_cast<int>(curve[moved].x) - 1,
                       static_cast<int>(curve[moved].y)))
        << moved;
  }
}

TEST(ChangesTest, RegionsNeverOverlap) {
  DrawnRectangles drawn;
  std::vector<std::array<float, 4>> scattered;
  for (int i = 0; i < 60; ++i) {
    const auto x = static_cast<float>((i * 73) % 300), y = static_cast<float>((i * 131) % 300);
    scattered.push_back({x, y, x + 4, y + 4});
  }
  drawn.changes({});
  const std::vector<PixelRect> regions = drawn.changes(scattered);
  for (std::size_t i = 0; i < regions.size(); ++i)
    for (std::size_t j = i + 1; j < regions.size(); ++j)
      EXPECT_TRUE(regions[i].cut_to(regions[j]).empty()) << i << " and " << j;
  for (const auto& r : scattered)
    EXPECT_TRUE(covers(regions, static_cast<int>(r[0]) + 1, static_cast<int>(r[1]) + 1));
}

}  // namespace
}  // namespace stillpoint::testing
