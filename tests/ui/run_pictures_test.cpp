// Pictures of several runs in one place: strips with dividers between, or one run after the other.
#include "ui/panels/run_pictures.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "core/check/findings.hpp"
#include "core/inspect/frame_view.hpp"
#include "core/inspect/run_view.hpp"
#include "core/odometry/frame_record.hpp"
#include "core/run/frame_figures.hpp"
#include "core/run/frame_scores.hpp"
#include "core/run/removal_errors.hpp"
#include "core/run/saved_map.hpp"
#include "core/run/sweep.hpp"
#include "tests/support/golden.hpp"
#include "tests/ui/panel_stage.hpp"
#include "tests/ui/session_example.hpp"
#include "ui/panels/panel_choices.hpp"
#include "ui/plot/plot.hpp"
#include "ui/shell/offscreen.hpp"
#include "ui/theme/text.hpp"
#include "ui/workbench/workbench.hpp"

namespace stillpoint::testing {
namespace {

using ::testing::ElementsAre;

/// A view of the same frame that removed a band across the whole picture, from row `top` on.
std::shared_ptr<const FrameView> with_band(const FrameView& view, int top) {
  auto current = std::make_shared<FrameView>(view);
  current->mask = cv::Mat(240, 320, CV_8UC1, cv::Scalar(0));
  current->mask.rowRange(top, top + 24) = 255;
  return current;
}

/// Three runs, each of which removed something in every strip, and each something else.
SessionView three_runs() {
  SessionView session = debug_example();
  session.current = with_band(*session.current, 70);
  session.debug.ghosts[0].current = with_band(*session.debug.ghosts[0].current, 105);
  session.debug.ghosts[1].current = with_band(*session.debug.ghosts[1].current, 140);
  return session;
}

/// The column of a divider, as it goes through all rows given.
int divider_between(const cv::Mat& image, int from, int to, const cv::Range& rows) {
  for (int x = from; x < to; ++x) {
    bool white = true;
    for (int y = rows.start; y < rows.end && white; y += 10)
      for (int channel = 0; channel < 3; ++channel) white &= image.at<cv::Vec3b>(y, x)[channel] > 205;
    if (white) return x;
  }
  return 0;
}

/// Another program's trajectory beside them.
SessionView with_trajectory(SessionView session) {
  GhostView ghost;
  ghost.name = "orb3";
  ghost.outside = true;
  auto run = std::make_shared<RunView>(*session.run);
  for (FrameRecord& record : run->records) record.features.clear();
  auto current = std::make_shared<FrameView>(*session.current);
  current->mask = cv::Mat();
  current->record = &run->records[static_cast<std::size_t>(current->index)];
  ghost.run = run;
  ghost.current = current;
  session.debug.ghosts.push_back(ghost);
  return session;
}

/// One panel offscreen, by the runs that are shown.
class Strips {
 public:
  explicit Strips(const std::string& name) : panels_(make_panels()) {
    for (const auto& panel : panels_)
      if (panel->name() == name) panel_ = panel.get();
  }
  ~Strips() {
    EXPECT_THAT(offscreen_.take_gl_errors(), ::testing::IsEmpty());
    offscreen_.make_current();
  }

  cv::Mat render(const SessionView& session) {
    return offscreen_.render([&](UiFrame& frame) { draw(frame, session); });
  }
  void play(const SessionView& session, const std::vector<InputEvent>& events) {
    for (const InputEvent& event : events) {
      offscreen_.send(event);
      for (int i = 0; i < 2; ++i) offscreen_.draw([&](UiFrame& frame) { draw(frame, session); });
    }
  }
  cv::Mat flipped_to(const SessionView& session, const std::string& name) {
    runs.pictures = RunPictures::flipped;
    runs.flipped_to = name;
    return render(session);
  }

  RunsShown runs;
  PanelChoices choices;

 private:
  void draw(UiFrame& frame, const SessionView& session) {
    frame.runs = &runs;
    frame.choices = &choices;
    ImGui::SetNextWindowPos({0, 0});
    ImGui::SetNextWindowSize(frame.size);
    ImGui::Begin("stage", nullptr, ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove);
    PanelActions ignored;
    draw_by_runs(frame, session, *panel_, ignored);
    ImGui::End();
  }

  Offscreen offscreen_{{.width = 640, .height = 480}};
  std::vector<std::unique_ptr<Panel>> panels_;
  Panel* panel_ = nullptr;
};

const std::vector<std::string> kRunNames = {"stillpoint", "motion.border_px 7", "method none"};

TEST(RunPictures, GoldenImageOfThreeRunsAndATrajectory) {
  const SessionView session = with_trajectory(three_runs());
  Strips strips("mask");
  strips.runs.pictures = RunPictures::wiped;
  strips.runs.chosen = kRunNames;
  strips.runs.chosen.emplace_back("orb3");
  strips.runs.dividers = {0.2F, 0.5F, 0.75F};
  EXPECT_TRUE(matches_golden(strips.render(session), "wiped_mask"));
}

TEST(RunPictures, EachStripIsItsOwnRuns) {
  const SessionView session = three_runs();
  Strips strips("mask");
  strips.choices.want({{"Truth", "off"}});
  std::vector<cv::Mat> alone;
  for (const std::string& name : kRunNames) alone.push_back(strips.flipped_to(session, name));
  strips.runs.pictures = RunPictures::wiped;
  const cv::Mat wiped = strips.render(session);
  ASSERT_EQ(strips.runs.dividers.size(), 2U);
  // Rows between the controls and the names, and columns well within each third.
  const cv::Range rows(120, 330);
  for (int strip = 0; strip < 3; ++strip) {
    const cv::Range columns(60 + 190 * strip, 190 + 190 * strip);
    for (int run = 0; run < 3; ++run)
      EXPECT_EQ(images_agree(wiped(rows, columns), alone[static_cast<std::size_t>(run)](rows, columns),
                             {2, 20.0, 0.0}),
                run == strip)
          << "strip " << strip << ", run " << run;
  }
}

TEST(RunPictures, AllStripsFollowTheControls) {
  const SessionView session = three_runs();
  Strips strips("mask");
  strips.choices.want({{"Truth", "off"}});
  strips.runs.pictures = RunPictures::wiped;
  const cv::Mat overlay = strips.render(session);
  strips.choices.want({{"look", "Alone"}});
  strips.render(session);
  const cv::Mat alone = strips.render(session);
  // Without the frame below it, the picture of any run is flat where it removes nothing.
  for (int strip = 0; strip < 3; ++strip) {
    const cv::Rect there(70 + 190 * strip, 130, 20, 20);
    EXPECT_FALSE(images_agree(overlay(there), alone(there), {2, 20.0, 0.0})) << strip;
  }
}

TEST(RunPictures, DividersAreDraggedAndThePictureStays) {
  const SessionView session = three_runs();
  Strips strips("mask");
  strips.choices.want({{"Truth", "off"}});
  strips.runs.pictures = RunPictures::wiped;
  const cv::Mat before = strips.render(session);
  const int divider = divider_between(before, 120, 300, {60, 380});
  ASSERT_GT(divider, 0);
  const auto at = [](int x) { return MouseMoved{static_cast<float>(x), 230.0F}; };
  strips.play(session, {at(divider), MouseButton{0, true, {}}, at(divider - 60), MouseButton{0, false, {}}});
  EXPECT_LT(strips.runs.dividers[0], 0.27F);
  EXPECT_FLOAT_EQ(strips.runs.dividers[1], 2.0F / 3.0F);
  strips.play(session, {MouseMoved{-1e5F, -1e5F}});
  const cv::Mat after = strips.render(session);
  const cv::Range rows(120, 330);
  EXPECT_TRUE(
      images_agree(before(rows, cv::Range(450, 600)), after(rows, cv::Range(450, 600)), {2, 20.0, 0.0}));
  // A drag beside the dividers still moves the picture, once it is enlarged.
  strips.play(session, {at(500), MouseWheel{0.0F, 5.0F, {}}, MouseMoved{-1e5F, -1e5F}});
  const cv::Mat near = strips.render(session);
  strips.play(session, {at(500), MouseButton{0, true, {}}, at(560), MouseButton{0, false, {}},
                        MouseMoved{-1e5F, -1e5F}});
  EXPECT_FALSE(images_agree(near, strips.render(session), {2, 500.0, 0.0}));
  EXPECT_LT(strips.runs.dividers[0], 0.27F);
}

TEST(RunPictures, DividersStayInOrder) {
  const SessionView session = three_runs();
  Strips strips("mask");
  strips.runs.pictures = RunPictures::wiped;
  strips.runs.dividers = {0.4F, 0.5F};
  strips.choices.want({{"Truth", "off"}});
  const cv::Mat before = strips.render(session);
  const int divider = divider_between(before, 200, 300, {60, 380});
  ASSERT_GT(divider, 0);
  strips.play(session, {MouseMoved{static_cast<float>(divider), 230.0F}, MouseButton{0, true, {}},
                        MouseMoved{630.0F, 230.0F}, MouseButton{0, false, {}}});
  EXPECT_LT(strips.runs.dividers[0], strips.runs.dividers[1]);
  EXPECT_FLOAT_EQ(strips.runs.dividers[1], 0.5F);
}

TEST(RunPictures, PanelsWithoutARunsPictureAreAsTheyAre) {
  const SessionView session = three_runs();
  for (const char* name : {"input", "trajectory", "timeline"}) {
    Strips strips(name);
    const cv::Mat before = strips.render(session);
    strips.runs.pictures = RunPictures::wiped;
    EXPECT_TRUE(images_agree(strips.render(session), before, {0, 0.0, 0.0})) << name;
  }
}

TEST(RunPictures, EveryPanelIsDrawnByRuns) {
  SessionView session = with_trajectory(generated_example());
  GhostView ghost;
  ghost.name = "later";
  ghost.run = session.run;
  session.debug.ghosts.push_back(ghost);
  for (const std::string& name : panel_names()) {
    Strips strips(name);
    for (const RunPictures pictures : {RunPictures::wiped, RunPictures::flipped}) {
      strips.runs.pictures = pictures;
      for (const std::vector<std::string>& chosen : {std::vector<std::string>{},
                                                     {"orb3", "later"},
                                                     {"stillpoint", "orb3", "baseline none", "later"}}) {
        strips.runs.chosen = chosen;
        strips.runs.flipped_to = chosen.empty() ? "" : chosen.back();
        EXPECT_FALSE(is_blank(strips.render(session), 8)) << name;
      }
    }
  }
}

/// The workbench with three runs, its keys and its palette.
class RunKeys : public ::testing::Test {
 protected:
  RunKeys() : workbench_(make_panels(), {.request = [](const SessionRequest&) {}}) {}
  ~RunKeys() override { offscreen_.make_current(); }
  void draw() {
    offscreen_.draw([this](UiFrame& frame) { workbench_.draw(frame, &session_); });
  }
  void strike(Key key, Modifiers modifiers = {}) {
    offscreen_.send(KeyChanged{key, true, modifiers});
    draw();
    offscreen_.send(KeyChanged{key, false, {}});
    draw();
    draw();
  }
  [[nodiscard]] std::string runs() const { return workbench_.fact("runs", &session_).value_or(""); }

  SessionView session_ = three_runs();
  Offscreen offscreen_{{.width = 1280, .height = 800}};
  Workbench workbench_;
};

TEST_F(RunKeys, WipeAndFlip) {
  draw();
  EXPECT_EQ(runs(), "none");
  strike(Key::kW);
  EXPECT_EQ(runs(), "wipe stillpoint motion.border_px 7 method none");
  strike(Key::kF);
  EXPECT_EQ(runs(), "flip stillpoint motion.border_px 7* method none");
  strike(Key::kF);
  strike(Key::kF);
  EXPECT_EQ(runs(), "flip stillpoint* motion.border_px 7 method none");
  strike(Key::kF, {.shift = true});
  EXPECT_EQ(runs(), "flip stillpoint motion.border_px 7 method none*");
  strike(Key::kW);
  strike(Key::kW);
  EXPECT_EQ(runs(), "none");
}

TEST_F(RunKeys, ThePaletteChoosesAmongRuns) {
  strike(Key::kW);
  strike(Key::kP, {.ctrl = true, .shift = true});
  ASSERT_TRUE(workbench_.palette_open());
  for (const char letter : std::string("leave border out")) {
    offscreen_.send(TextTyped{static_cast<unsigned char>(letter)});
    draw();
  }
  draw();
  strike(Key::kEnter);
  EXPECT_EQ(runs(), "wipe stillpoint method none");
  // One run alone has nothing to be wiped against.
  session_.debug.ghosts.clear();
  draw();
  EXPECT_FALSE(workbench_.actions().run("flip_runs"));
}

TEST_F(RunKeys, ThePaletteGoesOnAfterAnEnterThatFoundNothing) {
  const auto type = [this](const std::string& text) {
    for (const char letter : text) {
      offscreen_.send(TextTyped{static_cast<unsigned char>(letter)});
      draw();
    }
    draw();
  };
  strike(Key::kP, {.ctrl = true, .shift = true});
  type("qqq");
  strike(Key::kEnter);
  EXPECT_TRUE(workbench_.palette_open());
  for (int i = 0; i < 3; ++i) strike(Key::kBackspace);
  type("wipe runs against");
  strike(Key::kEnter);
  EXPECT_FALSE(workbench_.palette_open());
  EXPECT_EQ(workbench_.runs().pictures, RunPictures::wiped);
}

TEST_F(RunKeys, AHiddenRunIsLeftOutOfPlotsAndIsStillListed) {
  const auto picture = [this] {
    draw();
    return offscreen_.render([this](UiFrame& frame) { workbench_.draw(frame, &session_); });
  };
  for (const char* panel : {"errors", "compare"}) {
    workbench_.set_layout({.panel = panel});
    workbench_.set_runs({});
    const cv::Mat all = picture();
    workbench_.set_runs({.hidden = {"motion.border_px 7"}});
    const cv::Mat fewer = picture();
    EXPECT_GT(cv::norm(all, fewer, cv::NORM_INF), 50.0) << panel;
    if (std::string(panel) == "compare") continue;
    // The one that is left has the colour it had.
    const Rgb green = okabe_ito::kGreen, purple = okabe_ito::kPurple;
    const auto count = [](const cv::Mat& image, Rgb colour) {
      cv::Mat there;
      cv::inRange(image, cv::Scalar(colour.b, colour.g, colour.r), cv::Scalar(colour.b, colour.g, colour.r),
                  there);
      return cv::countNonZero(there);
    };
    EXPECT_GT(count(all, purple), 20);
    EXPECT_GT(count(fewer, green), 20);
    EXPECT_EQ(count(fewer, purple), 0);
  }
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

TEST(Bookmarks, NotesHaveTheRoomOfANarrowTile) {
  // Where the time would stand in a wider tile, a note is typed.
  const SessionView session = debug_example();
  PanelStage stage("bookmarks", {}, 280, 240);
  bool typed = false;
  for (float y = 40.0F; y < 110.0F && !typed; y += 8.0F) {
    stage.play(session, {MouseMoved{100.0F, y}, MouseButton{0, true, {}}, MouseButton{0, false, {}}});
    stage.play(session, {TextTyped{'z'}});
    for (const SessionRequest& request :
         stage.play(session, {KeyChanged{Key::kEnter, true, {}}, KeyChanged{Key::kEnter, false, {}}})
             .requests)
      if (const auto* marks = std::get_if<request::Bookmarks>(&request))
        for (const Bookmark& bookmark : marks->all) typed |= bookmark.note.find('z') != std::string::npos;
  }
  EXPECT_TRUE(typed);
}

TEST(Text, LinesEndAtSpacesAndFiguresKeepTheirUnits) {
  Offscreen offscreen({.width = 64, .height = 64});
  offscreen.draw([](UiFrame& frame) {
    const ImFont& font = *frame.fonts.text;
    const auto width = [&](const std::string& text) {
      return font.CalcTextSizeA(font.FontSize, 1e6F, 0.0F, text.c_str()).x;
    };
    const std::string text = "frame 417 was lost for 0.81 s after 12 px of blur";
    for (const float room : {90.0F, 120.0F, 150.0F}) {
      const std::string lines = in_lines(font, text, room);
      std::string whole = lines;
      std::replace(whole.begin(), whole.end(), '\n', ' ');
      EXPECT_EQ(whole, text);
      EXPECT_NE(lines, text);
      EXPECT_EQ(lines.find("0.81\n"), std::string::npos) << lines;
      EXPECT_EQ(lines.find("12\n"), std::string::npos) << lines;
      for (std::size_t at = 0; at < lines.size();) {
        const std::size_t end = std::min(lines.find('\n', at), lines.size());
        EXPECT_LE(width(lines.substr(at, end - at)), room) << lines;
        at = end + 1;
      }
    }
    EXPECT_FLOAT_EQ(widest_word(font, "a longest b"), width("longest"));
    EXPECT_LE(width(cut_to(font, text, 100.0F)), 100.0F);
    EXPECT_EQ(cut_to(font, text, 1e4F), text);
  });
}

TEST_F(RunKeys, AHiddenBaselineLeavesTheTrajectoryAndComesBackByTheList) {
  session_.debug.ghosts.clear();
  const Rgb baseline = role_colour(Role::kBaseline, ThemeName::kDark);
  const auto picture = [this](const char* panel, const std::vector<std::string>& hidden) {
    if (panels_of(workbench_.layout()) != std::vector<std::string>{panel})
      workbench_.set_layout({.panel = panel});
    RunsShown runs;
    runs.hidden = hidden;
    workbench_.set_runs(runs);
    draw();
    return offscreen_.render([this](UiFrame& frame) { workbench_.draw(frame, &session_); });
  };
  const auto count = [&](const cv::Mat& image) {
    cv::Mat there;
    const cv::Scalar colour(baseline.b, baseline.g, baseline.r);
    cv::inRange(image, colour, colour, there);
    return cv::countNonZero(there);
  };
  EXPECT_GT(count(picture("trajectory", {})), 20);
  EXPECT_EQ(count(picture("trajectory", {"baseline none"})), 0);
  EXPECT_GT(count(picture("trajectory", {})), 20);
  // The list has it whether hidden or not.
  EXPECT_GT(count(picture("compare", {"baseline none"})), 5);
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
