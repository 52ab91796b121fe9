#include "ui/shell/recording.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.hpp"
#include "tests/unit/temporary_folder.hpp"
#include "ui/shell/event_log.hpp"
#include "ui/shell/ui_pace.hpp"

namespace stillpoint {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr const char* kHead = "stillpoint recording 1\n";

/// The words of each event of a recording.
std::vector<std::string> words_of(const std::string& text) {
  std::vector<std::string> words;
  for (const RecordedLine& line : parse_recording(kHead + text, "a.txt").lines)
    words.push_back(to_line(line.what));
  return words;
}

/// What reading complains of.
std::string recording_complaint(const std::string& text) {
  try {
    (void)parse_recording(text, "a.txt");
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(Recording, EveryEventComesBackAsItWasWritten) {
  const std::vector<std::string> lines = {"wait 0.5",
                                          "idle",
                                          "until 12",
                                          "frame 3",
                                          "action toggle_theme",
                                          "point errors 0.5 0.25",
                                          "size 800 600",
                                          "screenshot after it.png",
                                          "expect panels input,errors",
                                          "move 12.5 -3",
                                          "press left",
                                          "release middle Ctrl+Shift",
                                          "wheel 0 -2 Alt",
                                          "key Ctrl+Shift+P down",
                                          "key None up",
                                          "key Ctrl+None down",
                                          "focus out",
                                          "drop /a folder/with blanks",
                                          "quit"};
  std::string text;
  for (const std::string& line : lines) text += line + "\n";
  EXPECT_EQ(words_of(text), lines);
}

TEST(Recording, ShortHandsStandForSeveralEvents) {
  EXPECT_THAT(words_of("click right Ctrl"), ElementsAre("press right Ctrl", "release right Ctrl"));
  EXPECT_THAT(words_of("key Ctrl+P"), ElementsAre("key Ctrl+P down", "key P up"));
  EXPECT_THAT(words_of("text \"a ü\"\""),
              ElementsAre("text \"a\"", "text \" \"", "text \"ü\"", "text \"\"\""));
  EXPECT_THAT(words_of("# a remark\n\n   \nidle\n"), ElementsAre("idle"));
}

TEST(Recording, TheStartComesBack) {
  RecordingStart start;
  start.sequence_name = "my sequence";
  start.sequence_frames = 30;
  start.opened_from = "/some where/my sequence";
  start.size = {1000, 700};
  start.theme = "light";
  start.scale = 1.25;
  start.layout = R"({"panel": "input"})";
  start.settings = {"run.method=paper", "features.count=900"};
  const RecordingStart read = parse_recording(to_text(start) + "idle\n", "a.txt").start;
  EXPECT_EQ(to_text(read), to_text(start));
  EXPECT_EQ(read.sequence_name, start.sequence_name);
  EXPECT_EQ(read.opened_from, start.opened_from);
  EXPECT_EQ(read.sequence_line, 2);
}

TEST(Recording, SizeIsAStartBeforeTheFirstEventAndOneAfterIt) {
  const Recording recording =
      parse_recording(std::string(kHead) + "size 300 200\nidle\nsize 400 300\n", "a.txt");
  EXPECT_EQ(recording.start.size, (std::array{300, 200}));
  ASSERT_EQ(recording.lines.size(), 2U);
  EXPECT_EQ(to_line(recording.lines[1].what), "size 400 300");
  EXPECT_EQ(recording.lines[1].line, 4);
}

TEST(Recording, SaysWhatIsWrongAndWhere) {
  EXPECT_THAT(recording_complaint(""), HasSubstr(":1: is no recording"));
  EXPECT_THAT(recording_complaint("hello\nidle\n"), HasSubstr(":1: is no recording"));
  EXPECT_THAT(recording_complaint("stillpoint recording 7\n"), HasSubstr(":1: is of another version"));
  const auto of_line = [](const std::string& line) { return recording_complaint(kHead + ("idle\n" + line)); };
  EXPECT_THAT(of_line("jump"), HasSubstr("a.txt:3: 'jump' is nothing that can happen"));
  EXPECT_THAT(of_line("wait soon"), HasSubstr(":3: expected seconds"));
  EXPECT_THAT(of_line("wait -1"), HasSubstr("found '-1'"));
  EXPECT_THAT(of_line("wait inf"), HasSubstr("found 'inf'"));
  EXPECT_THAT(of_line("wait"), HasSubstr("expected seconds after 'wait'"));
  EXPECT_THAT(of_line("idle now"), HasSubstr("'now' is more than 'idle' takes"));
  EXPECT_THAT(of_line("until 1.5"), HasSubstr("whole number"));
  EXPECT_THAT(of_line("press thumb"), HasSubstr("expected left, right or middle"));
  EXPECT_THAT(of_line("click left Hyper"), HasSubstr("expected modifiers"));
  EXPECT_THAT(of_line("key Ctrl+"), HasSubstr("expected a key"));
  EXPECT_THAT(of_line("key A sideways"), HasSubstr("expected down or up"));
  EXPECT_THAT(of_line("point errors 2 0"), HasSubstr("x as a share"));
  EXPECT_THAT(of_line("text hello"), HasSubstr("between quotes"));
  EXPECT_THAT(of_line("text \"\xC3\""), HasSubstr("not UTF-8"));
  EXPECT_THAT(of_line("size 0 0"), HasSubstr("a width from 16"));
  EXPECT_THAT(recording_complaint(std::string(kHead) + "look pink 1\n"),
              HasSubstr(":2: expected dark or light"));
  EXPECT_THAT(recording_complaint(std::string(kHead) + "sequence many x\n"),
              HasSubstr(":2: expected a number of frames"));
}

class RecorderTest : public ::testing::Test {
 protected:
  [[nodiscard]] std::vector<std::string> written() const {
    std::vector<std::string> words;
    for (const RecordedLine& line : read_recording(path()).lines) words.push_back(to_line(line.what));
    return words;
  }
  [[nodiscard]] std::filesystem::path path() const { return folder_.path("recording.txt"); }

  TemporaryFolder folder_;
};

TEST_F(RecorderTest, KeepsPausesAndTheLastOfMovements) {
  Recorder recorder(path(), {});
  recorder.event(MouseMoved{1, 1}, 0.00, {});
  recorder.event(MouseMoved{2, 2}, 0.01, {});
  recorder.event(MouseButton{0, true, {}}, 0.02, {});
  recorder.event(MouseButton{0, false, {}}, 0.52, {});
  recorder.event(KeyChanged{Key::kRight, true, {}}, 99.0, {});
  recorder.size(800, 600);
  recorder.size(800, 600);
  recorder.finish();
  EXPECT_THAT(written(), ElementsAre("move 2 2", "press left", "wait 0.5", "release left", "wait 1",
                                     "key Right down", "size 800 600"));
}

TEST_F(RecorderTest, WritesWhatToWaitFor) {
  Recorder recorder(path(), {});
  recorder.event(KeyChanged{Key::kSpace, true, {}}, 0.0, {.frame = 1, .playing = false, .idle = true});
  recorder.state({.frame = 2, .playing = true, .idle = false});
  recorder.event(KeyChanged{Key::kSpace, true, {}}, 0.0, {.frame = 9, .playing = true, .idle = false});
  recorder.state({.frame = 10, .playing = false, .idle = false});
  recorder.event(KeyChanged{Key::kRight, true, {}}, 0.0, {.frame = 10, .playing = false, .idle = true});
  recorder.event(KeyChanged{Key::kRight, false, {}}, 0.0, {.frame = 10, .playing = false, .idle = true});
  recorder.state({.frame = 11, .playing = false, .idle = false});
  recorder.finish();
  EXPECT_THAT(written(), ElementsAre("key Space down", "until 9", "key Space down", "idle", "frame 10",
                                     "key Right down", "key Right up", "idle"));
}

TEST_F(RecorderTest, SaysWhenItCannotWrite) {
  EXPECT_THROW(Recorder("/nowhere/at/all", {}), InputError);
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "there is no /dev/full";
  EXPECT_THROW(Recorder("/dev/full", {}), InputError);
}

TEST(EventLog, SaysTheSameOnce) {
  EventLog log;
  log.add({1.0, 3, true, "a"});
  log.add({2.0, -1, false, "b"});
  log.add({3.0, 5, true, "a"});
  log.add({4.0, 5, false, ""});
  ASSERT_EQ(log.entries().size(), 2U);
  EXPECT_EQ(log.entries()[1].text, "a");
  EXPECT_EQ(log.entries()[1].times, 2);
  EXPECT_EQ(log.entries()[1].frame, 5);
  EXPECT_EQ(log.errors(), 1);
  for (int i = 0; i < 1000; ++i) log.add({0.0, i, false, std::to_string(i)});
  EXPECT_EQ(log.entries().size(), EventLog::kKept);
  EXPECT_EQ(log.entries().back().text, "999");
}

TEST(UiPace, CountsOnlyWhatIsBesideWork) {
  UiPace pace;
  pace.add(80.0, false);
  pace.add(20.0, true);
  pace.add(60.0, true);
  EXPECT_EQ(pace.frames, 3);
  EXPECT_DOUBLE_EQ(pace.mean_ms, 160.0 / 3.0);
  EXPECT_EQ(pace.busy_frames, 2);
  EXPECT_EQ(pace.busy_over_limit, 1);
  EXPECT_DOUBLE_EQ(pace.longest_busy_ms, 60.0);
}

}  // namespace
}  // namespace stillpoint
