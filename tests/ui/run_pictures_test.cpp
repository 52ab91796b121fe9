// Pictures of several runs in one place: strips with dividers between, or one run after the other.
#include "ui/panels/run_pictures.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "core/odometry/frame_record.hpp"
#include "core/run/frame_figures.hpp"
#include "tests/support/golden.hpp"
#include "tests/ui/three_runs.hpp"
#include "ui/panels/panel_choices.hpp"
#include "ui/shell/offscreen.hpp"
#include "ui/workbench/workbench.hpp"

namespace stillpoint::testing {
namespace {

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
  for (std::size_t i = 0; i < run->records.size(); ++i)
    run->records.change(i, [](FrameRecord& record) {
      record.features.clear();
      record.measured = poses_alone();
    });
  auto current = std::make_shared<FrameView>(*session.current);
  current->mask = cv::Mat();
  current->record = record_in(*run, static_cast<std::size_t>(current->index));
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
  strips.runs.only = kRunNames;
  strips.runs.only.emplace_back("orb3");
  strips.runs.dividers = {0.2F, 0.5F, 0.75F};
  EXPECT_TRUE(matches_golden(strips.render(session), "wiped_mask"));
}

TEST(RunPictures, EachStripIsItsOwnRuns) {
  const SessionView session = three_runs();
  Strips strips("mask");
  strips.choices.want({{"Truth", "off"}});
  std::vector<cv::Mat> alone;
  for (const std::string& name : kRunNames) alone.push_back(strips.flipped_to(session, name));
  strips.runs.only = kRunNames;
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
  strips.runs.only = kRunNames;
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

TEST(RunPictures, ASingleRunTickedIsTheOneSeen) {
  const SessionView session = three_runs();
  Strips strips("mask");
  const cv::Mat other = strips.flipped_to(session, kRunNames[2]);
  strips.runs = {.pictures = RunPictures::wiped, .only = {kRunNames[2]}};
  EXPECT_TRUE(images_agree(strips.render(session), other, {2, 20.0, 0.0}));
  strips.runs.only = {kRunNames[0]};
  EXPECT_FALSE(images_agree(strips.render(session), other, {2, 20.0, 0.0}));
}

TEST(RunPictures, DividersAreDraggedAndThePictureStays) {
  const SessionView session = three_runs();
  Strips strips("mask");
  strips.choices.want({{"Truth", "off"}});
  strips.runs.only = kRunNames;
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
  strips.runs.only = kRunNames;
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
  for (const char* name : {"trajectory", "timeline", "disparity"}) {
    Strips strips(name);
    const cv::Mat before = strips.render(session);
    strips.runs.pictures = RunPictures::wiped;
    EXPECT_TRUE(images_agree(strips.render(session), before, {0, 0.0, 0.0})) << name;
  }
}

/// The runs with second frames of their own: in each, other features were found.
SessionView with_second_frames(SessionView session) {
  session.debug.other_is = OtherFrame::before;
  const Frame frame = session.current->frame;
  const auto view_of = [&frame](const RunView& run, std::size_t row, int shift) {
    struct Held {
      FrameView view;
      FrameRecord record;
    };
    auto held = std::make_shared<Held>();
    held->record = run.records[row];
    for (FeatureRecord& feature : held->record.features) {
      feature.pixel.y += static_cast<float>(shift);
      feature.fate = shift == 0 ? FeatureFate::inlier : FeatureFate::outlier;
      feature.map_point = static_cast<int>(&feature - held->record.features.data());
    }
    held->view.index = held->record.index;
    held->view.frame = frame;
    held->view.record = &held->record;
    return std::shared_ptr<const FrameView>(held, &held->view);
  };
  const auto row = static_cast<std::size_t>(session.current->index);
  const auto pair = [&](const RunView& run, int shift) {
    return BesideFrame{view_of(run, row, shift), view_of(run, row - 1, shift)};
  };
  const BesideFrame own = pair(*session.run, 0), ghost = pair(*session.run, 9);
  session.current = own.current, session.debug.other = own.other;
  session.debug.ghosts.resize(1);
  session.debug.ghosts[0].current = ghost.current, session.debug.ghosts[0].other = ghost.other;
  session.baseline = nullptr;
  return session;
}

TEST(RunPictures, TwoFramesAreOfEachRun) {
  const SessionView session = with_second_frames(three_runs());
  Strips strips("two_frames");
  strips.choices.want({{"Lines", "off"}});
  const cv::Mat own = strips.render(session), other = strips.flipped_to(session, kRunNames[1]);
  EXPECT_FALSE(images_agree(own, other, {2, 200.0, 0.0}));
  strips.runs = {.pictures = RunPictures::wiped};
  const cv::Mat wiped = strips.render(session);
  // Of each of the two pictures the left part is the session's own run's, the right part the other's.
  const cv::Range rows(60, 150);
  const auto agree = [&](const cv::Mat& alone, int from, int to) {
    return images_agree(wiped(rows, cv::Range(from, to)), alone(rows, cv::Range(from, to)), {2, 20.0, 0.0});
  };
  for (const int left : {20, 335}) {
    EXPECT_TRUE(agree(own, left, left + 120));
    EXPECT_FALSE(agree(other, left, left + 120));
    EXPECT_TRUE(agree(other, left + 165, left + 280));
    EXPECT_FALSE(agree(own, left + 165, left + 280));
  }
  // A line between them would cross what is another run's.
  strips.choices.want({{"Lines", "on"}});
  strips.render(session);
  EXPECT_TRUE(images_agree(strips.render(session)(rows, cv::Range::all()), wiped(rows, cv::Range::all()),
                           {2, 20.0, 0.0}));
}

TEST(RunPictures, TheInputIsEveryRunsButNotWhatItIsComparedWith) {
  SessionView session = three_runs();
  auto other = std::make_shared<FrameView>(*session.debug.ghosts[0].current);
  other->reference.colour = cv::Mat(other->frame.colour.size(), CV_8UC3, cv::Scalar(20, 200, 40));
  cv::cvtColor(other->reference.colour, other->reference.gray, cv::COLOR_BGR2GRAY);
  session.debug.ghosts[0].current = other;
  Strips strips("input");
  const cv::Mat alone = strips.render(session);
  const cv::Mat flipped = strips.flipped_to(session, kRunNames[1]);
  // The picture is as it was; below it stands that it is every run's.
  const cv::Range picture(60, 400);
  EXPECT_TRUE(images_agree(alone.rowRange(picture), flipped.rowRange(picture), {2, 20.0, 0.0}));
  EXPECT_FALSE(images_agree(alone, flipped, {2, 20.0, 0.0}));
  strips.choices.want({{"what", "Frame t−1"}});
  strips.render(session);
  const cv::Mat reference = strips.render(session);
  EXPECT_FALSE(images_agree(alone.rowRange(picture), reference.rowRange(picture), {2, 2000.0, 0.0}));
  const cv::Vec3b middle = reference.at<cv::Vec3b>(230, 320);
  EXPECT_EQ(middle, cv::Vec3b(20, 200, 40));
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
                                                     {"stillpoint", "orb3", "none (baseline)", "later"}}) {
        strips.runs.only = chosen;
        strips.runs.flipped_to = chosen.empty() ? "" : chosen.back();
        EXPECT_FALSE(is_blank(strips.render(session), 8)) << name;
      }
    }
  }
}

}  // namespace
}  // namespace stillpoint::testing
