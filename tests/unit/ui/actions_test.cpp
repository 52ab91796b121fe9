#include "ui/session/actions.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "core/check/findings.hpp"
#include "core/inspect/frame_view.hpp"
#include "core/inspect/run_view.hpp"
#include "core/odometry/frame_record.hpp"
#include "core/run/frame_scores.hpp"
#include "core/run/removal_errors.hpp"
#include "core/run/saved_map.hpp"
#include "core/run/sweep.hpp"
#include "ui/workbench/palette.hpp"

namespace stillpoint {
namespace {

using ::testing::ElementsAre;

TEST(Actions, RunByNameAndKeyWhileEnabled) {
  Actions actions;
  int runs = 0;
  bool enabled = true;
  actions.add({.name = "step",
               .title = "Step forward",
               .group = "Playback",
               .keys = {{Key::kRight, {}}},
               .enabled = [&] { return enabled; },
               .run = [&] { ++runs; }});
  EXPECT_TRUE(actions.run("step"));
  EXPECT_FALSE(actions.run("leap"));
  EXPECT_EQ(actions.for_key({Key::kRight, {}}), actions.find("step"));
  EXPECT_EQ(actions.for_key({Key::kRight, {.ctrl = true}}), nullptr);
  enabled = false;
  EXPECT_FALSE(actions.run("step"));
  EXPECT_EQ(actions.for_key({Key::kRight, {}}), nullptr);
  EXPECT_EQ(runs, 1);
  EXPECT_EQ(key_text(*actions.find("step")), "Right");
}

TEST(Actions, NamesAndKeysAreTakenOnce) {
  Actions actions;
  actions.add({.name = "a", .title = "A", .group = "G", .keys = {{Key::kA, {}}}, .run = [] {}});
  EXPECT_THROW(actions.add({.name = "a", .title = "B", .group = "G", .run = [] {}}), std::logic_error);
  EXPECT_THROW(actions.add({.name = "b", .title = "B", .group = "G", .keys = {{Key::kA, {}}}, .run = [] {}}),
               std::logic_error);
}

PaletteRow palette_row(const std::string& title, const std::string& words = "", const std::string& off = "") {
  return {.icon = "", .title = title, .words = words, .off = off};
}

std::vector<std::string> found(const std::vector<PaletteRow>& rows, const std::string& query) {
  std::vector<std::string> titles;
  for (const PaletteRow& row : found_rows(rows, query)) titles.push_back(row.title);
  return titles;
}

TEST(PaletteRows, AreFoundByLettersInOrder) {
  const std::vector<PaletteRow> rows{palette_row("Next lost frame"), palette_row("Next keyframe"),
                                     palette_row("Reset layout")};
  EXPECT_THAT(found(rows, "nk"), ElementsAre("Next keyframe"));
  EXPECT_THAT(found(rows, "NEXT"), ElementsAre("Next keyframe", "Next lost frame"));
  EXPECT_THAT(found(rows, "zebra"), ElementsAre());
  EXPECT_THAT(found(rows, ""), ElementsAre("Next lost frame", "Next keyframe", "Reset layout"));
}

TEST(PaletteRows, WordsBeatLettersAndWhatCannotBeDoneStandsLast) {
  const std::vector<PaletteRow> rows{palette_row("The rest hold off"),  // letters of "threshold" in order
                                     palette_row("Difference limit", "the threshold of grey levels"),
                                     palette_row("Threshold of residuals"),
                                     palette_row("Threshold again", "", "No sequence is open.")};
  EXPECT_THAT(found(rows, "threshold"), ElementsAre("Threshold of residuals", "Difference limit",
                                                    "The rest hold off", "Threshold again"));
  EXPECT_THAT(found(rows, "levels grey"), ElementsAre("Difference limit"));
}

TEST(PaletteRows, AFrameIsAskedForByItsNumber) {
  EXPECT_EQ(frame_asked_for("417"), 417);
  EXPECT_EQ(frame_asked_for(" Frame 417 "), 417);
  EXPECT_EQ(frame_asked_for("frame"), std::nullopt);
  EXPECT_EQ(frame_asked_for("4 17"), std::nullopt);
  EXPECT_EQ(frame_asked_for("-3"), std::nullopt);
  EXPECT_EQ(frame_asked_for("41x"), std::nullopt);
}

bool holds(const std::vector<int>& all, int one) {
  return std::find(all.begin(), all.end(), one) != all.end();
}

SessionView session_at(int index, const std::vector<int>& keyframes, const std::vector<int>& lost,
                       int count) {
  auto run = std::make_shared<RunView>();
  for (int i = 0; i < count; ++i) {
    FrameRecord record;
    record.index = i;
    record.status = holds(lost, i) ? FrameStatus::lost : FrameStatus::tracked;
    record.keyframe = holds(keyframes, i);
    run->records.push_back(record);
  }
  auto current = std::make_shared<FrameView>();
  current->index = index;
  SessionView session;
  session.run = run;
  session.current = current;
  session.frame_count = 100;
  session.processed = count;
  return session;
}

TEST(Navigation, GoesBetweenKeyframesAndToLostFrames) {
  EXPECT_EQ(next_keyframe(session_at(3, {0, 3, 8, 12}, {}, 20)), 8);
  EXPECT_EQ(previous_keyframe(session_at(3, {0, 3, 8}, {}, 20)), 0);
  EXPECT_EQ(previous_keyframe(session_at(0, {0, 3}, {}, 20)), std::nullopt);
  EXPECT_EQ(next_keyframe(session_at(12, {0, 12}, {}, 20)), std::nullopt);
  EXPECT_EQ(next_lost_frame(session_at(5, {}, {4, 9, 10}, 20)), 9);
  EXPECT_EQ(next_lost_frame(session_at(10, {}, {4, 9, 10}, 20)), std::nullopt);
  // Of frames not processed yet nothing is known.
  EXPECT_EQ(previous_keyframe(session_at(60, {0, 7}, {}, 20)), 7);
  EXPECT_EQ(next_keyframe(session_at(60, {0, 7}, {}, 20)), std::nullopt);
  EXPECT_EQ(next_keyframe(session_at(0, {}, {}, 0)), std::nullopt);
}

}  // namespace
}  // namespace stillpoint
