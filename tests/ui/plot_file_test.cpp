#include "ui/plot/plot_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <opencv2/imgcodecs.hpp>
#include <set>

#include "core/error.hpp"
#include "core/inspect/frame_view.hpp"
#include "core/odometry/frame_record.hpp"
#include "core/run/removal_errors.hpp"
#include "core/run/saved_map.hpp"
#include "core/run/sweep.hpp"
#include "tests/ui/session_example.hpp"
#include "tests/unit/temporary_folder.hpp"
#include "ui/panels/panel.hpp"
#include "ui/shell/offscreen.hpp"
#include "ui/workbench/workbench.hpp"

namespace stillpoint::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::StartsWith;

constexpr Rgb kRed{200, 0, 0}, kGreen{0, 130, 0}, kBlue{0, 0, 200};

/// Three flat curves at a quarter, a half and three quarters of an axis from 0 to 10, one with a gap.
class PlotFile : public ::testing::Test {
 protected:
  PlotFile() {
    high_.assign(11, 7.5), half_.assign(11, 5.0), low_.assign(11, 2.5);
    half_[4] = half_[5] = half_[6] = std::numeric_limits<double>::quiet_NaN();
    for (int i = 0; i <= 10; ++i) x_.push_back(i);
    plot_ = {.x_label = "time", .x_unit = "s", .y_label = "RPE", .y_unit = "mm"};
    plot_.series = {{"run, \"mine\"", x_, high_, kRed},
                    {"baseline", x_, half_, kGreen, SeriesStyle::kDashed},
                    {"ghost", x_, low_, kBlue}};
    view_.y = AxisRange{0.0, 10.0};
  }
  std::string written(const std::string& name) {
    write_plot(PlotFigure(plot_, view_), folder_.path(name));
    return folder_.read(name);
  }

  TemporaryFolder folder_;
  std::vector<double> x_, high_, half_, low_;
  Plot plot_;
  PlotView view_;
};

/// Rows in which a column has a colour: the middle one, nothing where there is none.
std::optional<double> row_of(const cv::Mat& image, int column, Rgb colour, int from, int to) {
  double sum = 0.0;
  int count = 0;
  for (int row = from; row < to; ++row) {
    const cv::Vec3b seen = image.at<cv::Vec3b>(row, column);
    if (std::abs(seen[2] - colour.r) + std::abs(seen[1] - colour.g) + std::abs(seen[0] - colour.b) > 60)
      continue;
    sum += row, ++count;
  }
  return count > 0 ? std::optional(sum / count) : std::nullopt;
}

TEST_F(PlotFile, HasCurvesWhereTheirValuesAre) {
  const std::string bytes = written("plot.png");
  const cv::Mat image = cv::imread(folder_.path("plot.png"), cv::IMREAD_COLOR);
  ASSERT_FALSE(image.empty());
  EXPECT_EQ(image.size(), cv::Size(1380, 780));
  // Below the legend, in a column at a third of the axis: one in which dashes leave nothing out is found.
  const int from = 120, to = image.rows - 90;
  std::optional<double> high, half, low;
  for (int column = 400; column < 430 && !half; ++column) {
    high = row_of(image, column, kRed, from, to), half = row_of(image, column, kGreen, from, to);
    low = row_of(image, column, kBlue, from, to);
  }
  ASSERT_TRUE(high && half && low);
  EXPECT_LT(*high, *half);
  EXPECT_NEAR(*half - *high, *low - *half, 2.0);
  EXPECT_GT(*half - *high, 100.0);  // a quarter of the axis
  // Nothing is drawn where nothing is known.
  for (int column = 680; column < 760; ++column)
    EXPECT_FALSE(row_of(image, column, kGreen, from, to)) << column;
}

TEST_F(PlotFile, IsTheSameFileTwice) {
  for (const char* name : {"plot.svg", "plot.pdf", "plot.png", "plot.csv"}) {
    const std::string once = written(name);
    EXPECT_GT(once.size(), 200U) << name;
    EXPECT_TRUE(written(name) == once) << name;
  }
  EXPECT_THAT(folder_.read("plot.svg"), HasSubstr("<svg"));
  EXPECT_THAT(folder_.read("plot.pdf"), StartsWith("%PDF-"));
  EXPECT_THAT(folder_.read("plot.pdf"), HasSubstr("%%EOF"));
}

TEST_F(PlotFile, ValuesAreARowEach) {
  const std::string text = written("plot.CSV");
  EXPECT_THAT(text, StartsWith("series,time (s),RPE (mm)\n\"run, \"\"mine\"\"\",0,7.5\n"));
  EXPECT_THAT(text, HasSubstr("\nbaseline,3,5\nbaseline,4,\n"));
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 1 + 3 * 11);
}

TEST_F(PlotFile, OutlivesWhatItWasMadeOf) {
  const PlotFigure figure(plot_, view_);
  const std::string before = plot_values(figure);
  high_.assign(11, 1.0);
  x_.assign(11, 0.0);
  EXPECT_EQ(plot_values(figure), before);
}

TEST_F(PlotFile, RefusesOtherEndingsAndPlacesThatAreNone) {
  EXPECT_THAT([&] { written("plot.bmp"); }, ::testing::ThrowsMessage<InputError>(HasSubstr(kPlotEndings)));
  EXPECT_THROW(written("plot"), InputError);
  EXPECT_THROW(written("nowhere/plot.svg"), InputError);
  plot_.series.clear();
  EXPECT_GT(written("empty.svg").size(), 200U);  // axes without a curve
}

/// Presses and lets go of a button at a place. @param draw draws as often as it takes to be noticed
template <typename Draw>
void click(Offscreen& offscreen, const Draw& draw, ImVec2 at, int button) {
  offscreen.send(MouseMoved{at.x, at.y});
  draw();
  for (const bool down : {true, false}) {
    offscreen.send(MouseButton{button, down, {}});
    draw();
  }
}

/// What a right click somewhere on a panel offers first, and the file it writes.
class RightClick : public ::testing::TestWithParam<std::pair<std::string, std::string>> {};

TEST_P(RightClick, SavesWhatThePanelShows) {
  const auto& [name, ending] = GetParam();
  const TemporaryFolder folder;
  Offscreen offscreen({.width = 700, .height = 560});
  const auto panels = make_panels();
  const auto found =
      std::find_if(panels.begin(), panels.end(), [&](const auto& p) { return p->name() == name; });
  ASSERT_NE(found, panels.end());
  SessionView session = debug_example();
  session.debug.check.looked = true;
  session.debug.check.findings = {{"depth", "Depth is missing in places."}};
  std::optional<FileOffer> offer;
  const auto draw = [&] {
    for (int i = 0; i < 3; ++i)
      offscreen.draw([&](UiFrame& frame) {
        frame.offer = &offer;
        ImGui::SetNextWindowPos({0, 0});
        ImGui::SetNextWindowSize(frame.size);
        ImGui::Begin("stage", nullptr, ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove);
        PanelActions ignored;
        (*found)->draw(frame, session, ignored);
        ImGui::End();
      });
  };
  draw();
  for (const float x : {330.0F, 560.0F})
    for (float y = 70.0F; y < 540.0F && !offer; y += 35.0F) {
      click(offscreen, draw, {x, y}, 1);
      click(offscreen, draw, {x + 30.0F, y + 18.0F}, 0);
    }
  ASSERT_TRUE(offer) << name;
  EXPECT_TRUE(offer->name.ends_with(ending)) << offer->name;
  offer->write(folder.path(offer->name));
  const std::string text = folder.read(offer->name);
  if (ending == ".csv")
    EXPECT_GT(std::count(text.begin(), text.end(), '\n'), 1) << text;
  else
    EXPECT_THAT(text, HasSubstr("<svg"));
  EXPECT_THROW(offer->write(folder.path("wrong.txt")), InputError);
  offscreen.make_current();
}

INSTANTIATE_TEST_SUITE_P(Panels, RightClick,
                         ::testing::Values(std::pair("errors", ".svg"), std::pair("timeline", ".svg"),
                                           std::pair("trajectory", ".svg"), std::pair("figures", ".svg"),
                                           std::pair("pose", ".svg"), std::pair("removal", ".svg"),
                                           std::pair("timings", ".svg"), std::pair("inspector", ".csv"),
                                           std::pair("compare", ".csv"), std::pair("bookmarks", ".csv"),
                                           std::pair("breakpoints", ".csv"), std::pair("log", ".csv"),
                                           std::pair("parameters", ".csv"), std::pair("check", ".csv"),
                                           std::pair("stages", ".csv")),
                         [](const auto& one) { return one.param.first; });

TEST_F(PlotFile, IsOfferedByARightClick) {
  Offscreen offscreen({.width = 900, .height = 700});
  Workbench workbench(make_panels());
  SessionView session = handmade_example();
  LayoutNode only, root;
  only.panel = "errors";
  root.children.push_back(only);
  workbench.set_layout(root);
  const auto draw = [&] {
    for (int i = 0; i < 3; ++i) offscreen.draw([&](UiFrame& frame) { workbench.draw(frame, &session); });
  };
  draw();
  const auto tile = workbench.tile_of("errors");
  ASSERT_TRUE(tile);
  const float x = tile->x + 0.5F * tile->width, y = tile->y + 0.4F * tile->height;
  click(offscreen, draw, {x, y}, 1);
  click(offscreen, draw, {x + 30.0F, y + 20.0F}, 0);  // the first of the menu
  // The path proposed is replaced by one of the test's.
  const std::string path = folder_.path("mine.svg");
  offscreen.send(KeyChanged{Key::kA, true, {.ctrl = true}});
  draw();
  offscreen.send(KeyChanged{Key::kA, false, {}});
  draw();
  for (const char c : path) offscreen.send(TextTyped{static_cast<unsigned>(c)});
  draw();
  for (const bool down : {true, false}) {
    offscreen.send(KeyChanged{Key::kEnter, down, {}});
    draw();
  }
  EXPECT_EQ(workbench.fact("message", &session).value_or(""), "written to " + path);
  EXPECT_THAT(folder_.read("mine.svg"), HasSubstr("<svg"));
}

TEST(PlotLegend, NamesTheRunItselfWhereThereIsRoomForFew) {
  const std::vector<double> x{0.0, 1.0}, y{1.0, 2.0};
  const Rgb own{10, 200, 30};
  Plot plot{.x_label = "time", .y_label = "RPE over 1 s"};
  plot.series = {{"baseline with a long name", x, y, {200, 30, 10}},
                 {"another run with a long name", x, y, {30, 10, 200}},
                 {"the run itself, by a long name", x, y, own}};
  Offscreen offscreen({.width = 280, .height = 160});
  PlotView view;
  const cv::Mat image = offscreen.render([&](UiFrame& frame) {
    ImGui::SetNextWindowPos({0, 0});
    ImGui::SetNextWindowSize(frame.size);
    ImGui::Begin("stage", nullptr, ImGuiWindowFlags_NoDecoration);
    draw_plot(frame, "plot", plot, view);
    ImGui::End();
  });
  cv::Mat swatch;
  const cv::Mat heading = image.rowRange(0, 26);
  cv::inRange(heading, cv::Scalar(own.b, own.g, own.r), cv::Scalar(own.b, own.g, own.r), swatch);
  EXPECT_GT(cv::countNonZero(swatch), 8);
}

/// The tables of the panel Feature, each by its own right click.
TEST(FeatureTables, AreBothOffered) {
  SessionView session = debug_example();
  auto current = std::make_shared<FrameView>(*session.current);
  ASSERT_FALSE(current->record->features.empty());
  auto before = std::make_shared<FrameRecord>(*current->record);
  before->index = current->index - 1;
  // Where the example's flow says that they came from.
  for (FeatureRecord& feature : before->features) feature.pixel.x -= 6.9F;
  current->history = {before};
  session.current = current;
  // High enough for all that is told of a feature to be seen.
  Offscreen offscreen({.width = 700, .height = 1600});
  const auto panels = make_panels();
  const auto found = std::find_if(panels.begin(), panels.end(),
                                  [](const auto& panel) { return panel->name() == "feature"; });
  ASSERT_NE(found, panels.end());
  std::optional<FileOffer> offer;
  std::set<std::string> names;
  const auto draw = [&] {
    for (int i = 0; i < 3; ++i)
      offscreen.draw([&](UiFrame& frame) {
        frame.offer = &offer;
        ImGui::SetNextWindowPos({0, 0});
        ImGui::SetNextWindowSize(frame.size);
        ImGui::Begin("stage", nullptr, ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove);
        PanelActions ignored;
        (*found)->draw(frame, session, ignored);
        ImGui::End();
      });
  };
  const auto click = [&](float x, float y, int button) {
    offscreen.send(MouseMoved{x, y});
    draw();
    for (const bool down : {true, false}) {
      offscreen.send(MouseButton{button, down, {}});
      draw();
    }
  };
  draw();
  for (float y = 700.0F; y < 1560.0F; y += 24.0F) {
    click(560.0F, y, 1);
    click(590.0F, y + 18.0F, 0);
    if (offer) names.insert(offer->name);
    offer.reset();
  }
  EXPECT_THAT(names, ElementsAre("feature.csv", "feature_trail.csv"));
  offscreen.make_current();
}

}  // namespace
}  // namespace stillpoint::testing
