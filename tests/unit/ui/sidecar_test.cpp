#include "core/inspect/sidecar.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.hpp"
#include "tests/cli/small_sequence.hpp"
#include "tests/unit/temporary_folder.hpp"
#include "ui/session/session.hpp"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;

const MarkedSequence kSequence{"film", "0123456789abcdef", 50};

Marks some_marks() {
  Marks marks;
  marks.bookmarks = {{3, "here \"it\" begins"}, {40, "über"}};
  marks.pins = {{2, 10.25, 11.5, "A"}};
  marks.breakpoints = {{"rpe > 5 cm || lost", true}, {"not a condition", false}};
  marks.drawn = {{5, {}}, {8, {{{1.5, 2}, {30, 2}, {30.25, 40}}, {{50, 50}, {60, 50}, {60, 60}, {50, 60}}}}};
  marks.span = FrameSpan{4, 9};
  marks.loop = true;
  return marks;
}

TEST(Marks, ComeBackAsTheyWereWritten) {
  const TemporaryFolder folder;
  write_marks(folder.path("m.json"), kSequence, some_marks());
  EXPECT_EQ(read_marks(folder.path("m.json"), kSequence), some_marks());
  write_marks(folder.path("m.json"), kSequence, {});
  EXPECT_EQ(read_marks(folder.path("m.json"), kSequence), Marks{});
  EXPECT_FALSE(fs::exists(folder.path("m.json.part")));
}

TEST(Marks, NestedBeyondAllReasonAreRefused) {
  const TemporaryFolder folder;
  write_marks(folder.path("m.json"), kSequence, some_marks());
  std::string text = folder.read("m.json");
  constexpr std::size_t kDeep = 1'000'000;
  const std::string before = "\"span\": ";
  const std::size_t at = text.find(before);
  ASSERT_NE(at, std::string::npos);
  text = text.substr(0, at + before.size()) + "{\"first\": " + std::string(kDeep, '[') +
         std::string(kDeep, ']') + "}}";
  folder.write("m.json", text);
  EXPECT_THAT(input_error_of([&] { (void)read_marks(folder.path("m.json"), kSequence); }),
              ::testing::HasSubstr("\"first\""));
}

struct BadFile {
  const char* from;
  const char* to;
  const char* why;
};

/// What the test is called by.
void PrintTo(const BadFile& file, std::ostream* to) { *to << file.why; }

class BadMarks : public ::testing::TestWithParam<BadFile> {};

TEST_P(BadMarks, AreRefusedInOneSentenceAndLeftAlone) {
  const TemporaryFolder folder;
  write_marks(folder.path("stillpoint.json"), kSequence, some_marks());
  std::string text = folder.read("stillpoint.json");
  const std::size_t at = text.find(GetParam().from);
  ASSERT_NE(at, std::string::npos);
  text.replace(at, std::string(GetParam().from).size(), GetParam().to);
  folder.write("stillpoint.json", text);
  Sidecar sidecar({.folder = folder.path(), .user_folder = {}}, kSequence);
  try {
    (void)sidecar.load();
    FAIL() << "was taken";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("stillpoint.json"), HasSubstr(GetParam().why)));
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
  }
  sidecar.save({});
  EXPECT_EQ(folder.read("stillpoint.json"), text);
}

INSTANTIATE_TEST_SUITE_P(
    All, BadMarks,
    ::testing::Values(BadFile{"{", "", "damaged"},
                      BadFile{"\"version\": 1", "\"version\": 7", "version 7, expected 1"},
                      BadFile{"stillpoint marks", "shopping list", "no file of marks"},
                      BadFile{"0123456789abcdef", "0123456789abcdee", "has changed since"},
                      BadFile{"\"name\": \"film\",\n    \"fingerprint\": \"01",
                              "\"name\": \"other\",\n    \"fingerprint\": \"ff", "another sequence"},
                      BadFile{"\"frame\": 40", "\"frame\": 50", "expected a frame from 0 to 49"},
                      BadFile{"\"frame\": 40", "\"frame\": \"x\"", "expected a frame"},
                      BadFile{"10.25", "null", "no number"},
                      BadFile{"\"enabled\": true", "\"enabled\": 1", "neither"},
                      BadFile{"\"first\": 4", "\"first\": 14", "ends before it begins"},
                      BadFile{"\"condition\"", "\"expression\"", "missing"}));

TEST(Sidecar, StaysInTheUsersFolderWhereTheSequenceCannotBeWritten) {
  const TemporaryFolder user;
  Sidecar sidecar({.folder = {}, .user_folder = user.path("sequences")}, kSequence);
  EXPECT_EQ(sidecar.load(), Marks{});
  EXPECT_FALSE(fs::exists(user.path("sequences")));  // nothing marked, nothing written
  sidecar.save(some_marks());
  Sidecar again({.folder = {}, .user_folder = user.path("sequences")}, kSequence);
  EXPECT_EQ(again.load(), some_marks());
  Sidecar other({.folder = {}, .user_folder = user.path("sequences")}, {"film", "ffff", 50});
  EXPECT_EQ(other.load(), Marks{});
}

TEST(Sidecar, ASessionFindsItsMarksAgain) {
  const SmallSequence folder(6);
  const std::shared_ptr<const FrameSource> source = open_sequence(folder.path());
  Config config;
  config.run.method = "none";
  config.features.count = 300;
  const SessionOptions options{.baseline = false, .sidecar = SidecarPlaces{folder.path(), {}}};
  {
    Session session(source, config, options);
    session.request(request::Bookmarks{{{2, "look"}}});
    session.request(request::Breakpoints{{{"keyframe", true}}});
    session.request(request::Span{FrameSpan{1, 3}, true});
  }
  ASSERT_TRUE(fs::exists(folder.path(kSidecarName)));
  Session session(source, config, options);
  session.request(request::GoTo{1});
  const DebugView& debug = session.view()->debug;
  EXPECT_THAT(debug.bookmarks, ::testing::ElementsAre(Bookmark{2, "look"}));
  ASSERT_EQ(debug.breakpoints.size(), 1U);
  EXPECT_EQ(debug.breakpoints[0].hits.front(), 0);
  EXPECT_EQ(debug.span, (FrameSpan{1, 3}));
  EXPECT_EQ(debug.sequence_hash.size(), 16U);

  // The sequence changes: the file is left, and the rest goes on.
  folder.folder.write(SmallSequence::colour(0), cv::Mat(240, 320, CV_8UC3, cv::Scalar(9, 9, 9)));
  const std::string before = folder.folder.read(kSidecarName);
  Session changed(source, config, options);
  changed.request(request::GoTo{1});
  EXPECT_THAT(changed.view()->message, HasSubstr("has changed since"));
  EXPECT_TRUE(changed.view()->debug.bookmarks.empty());
  changed.request(request::Bookmarks{{{4, "new"}}});
  EXPECT_EQ(changed.view()->debug.bookmarks.size(), 1U);
  EXPECT_EQ(folder.folder.read(kSidecarName), before);
}

}  // namespace
}  // namespace stillpoint
