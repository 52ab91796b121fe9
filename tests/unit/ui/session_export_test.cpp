#include "core/motion/paper/paper_config.hpp"
#include "core/run/open_run.hpp"
#include "tests/unit/ui/session_debug.hpp"

namespace stillpoint {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
namespace fs = std::filesystem;

TEST_F(SessionDebug, AFinishedRunsMasksAreScoredAsTheyWere) {
  write_masks(folder_);
  config_.run.method = "oracle";
  const TemporaryFolder out;
  {
    Session first(std::shared_ptr<const FrameSource>(open_sequence(folder_.path())), config_,
                  {.baseline = false});
    first.request(request::GoTo{3});
    first.request(request::ExportSession{out.path("run")});
    ASSERT_EQ(first.view()->message, "");
  }
  const OpenedRun run = open_run(out.path("run"));
  SessionOptions options;
  options.recorded = run.recorded;
  Session other(run.source, run.recorded->run.config, options);
  other.request(request::Breakpoints{{{"mask_iou > 99%", true}}});
  EXPECT_THAT(debug(other).breakpoints[0].hits, ElementsAre(0, 1, 2, 3));
  EXPECT_EQ(debug(other).breakpoints[0].note, "");
}

TEST_F(SessionDebug, ExportedFramesShowTheSame) {
  const auto s = session();
  s->request(request::Span{FrameSpan{3, 6}, false});
  const TemporaryFolder out;
  s->request(request::ExportFrames{out.path("part")});
  ASSERT_EQ(s->view()->message, "");
  const auto part = open_sequence(out.path("part"));
  ASSERT_EQ(part->size(), 4);
  for (int i = 0; i < 4; ++i) {
    const Frame a = part->read(i), b = source_->read(i + 3);
    EXPECT_NEAR(a.timestamp, b.timestamp, 1e-6);
    EXPECT_NEAR(a.depth_timestamp, b.depth_timestamp, 1e-6);
    EXPECT_EQ(cv::norm(a.gray, b.gray, cv::NORM_INF), 0.0);
    EXPECT_EQ(cv::norm(a.depth, b.depth, cv::NORM_INF), 0.0);
  }
  EXPECT_FALSE(part->ground_truth().empty());
  s->request(request::ExportFrames{out.path("part")});
  EXPECT_THAT(s->view()->message, HasSubstr("holds a sequence already"));
}

TEST_F(SessionDebug, ExportedFramesKeepTheirNumbers) {
  folder_.folder.write(SmallSequence::colour(4), std::string("no image"));
  folder_.folder.write(SmallSequence::depth(5), std::string("no image"));
  const auto s = session();
  s->request(request::Span{FrameSpan{3, 7}, false});
  const TemporaryFolder out;
  s->request(request::ExportFrames{out.path("part")});
  ASSERT_EQ(s->view()->message, "");
  EXPECT_THAT(debug(*s).notice, ::testing::AllOf(HasSubstr("5 frames"), HasSubstr("without images: 4")));
  const auto part = open_sequence(out.path("part"));
  ASSERT_EQ(part->size(), 5);
  for (int i = 0; i < 5; ++i) {
    const Frame frame = part->read(i);
    EXPECT_NEAR(frame.timestamp, source_->timestamp(i + 3), 1e-6);
    EXPECT_EQ(frame.readable(), i != 1) << i;
    EXPECT_EQ(frame.has_depth(), i != 1 && i != 2) << i;
    EXPECT_EQ(frame.problem.empty(), i != 1 && i != 2) << frame.problem;
  }
}

TEST_F(SessionDebug, ExportsGoOnBesideTheSessionAndCanBeStopped) {
  StartedSession s(session());
  s->request_frame(kDebugFrames - 1);
  EXPECT_TRUE(s.wait_for([](const SessionView& v) { return v.processed == kDebugFrames; }));
  const TemporaryFolder out;
  s->request(request::ExportSession{out.path("first")});
  s->request(request::ExportSession{out.path("second")});
  EXPECT_TRUE(s.wait_for([](const SessionView& v) { return !v.message.empty() || !v.debug.notice.empty(); }));
  s->request_frame(2);  // clears the message, and is done whatever is written meanwhile
  EXPECT_TRUE(s.wait_for([](const SessionView& v) { return v.current->index == 2; }));
  EXPECT_TRUE(s.wait_for([](const SessionView& v) { return !v.debug.exporting && !v.debug.notice.empty(); }));
  EXPECT_THAT(s->view()->debug.notice, HasSubstr("12 frames, their run"));
  EXPECT_EQ(open_run(out.path("first")).recorded->hash, s->view()->debug.run_hash);

  s->request(request::ExportSession{out.path("third")});
  s->request(request::StopExport{});
  EXPECT_TRUE(s.wait_for([](const SessionView& v) { return v.debug.notice.find("Stopped") == 0; }));
  EXPECT_FALSE(fs::exists(out.path("third")));
}

TEST_F(SessionDebug, ASessionIsHandedOnAsOneFolder) {
  const auto s = session();
  s->request(request::GoTo{7});
  const std::string hash = debug(*s).run_hash;
  s->request(request::Bookmarks{{{2, "look"}, {9, "beyond what is processed"}}});
  const TemporaryFolder out;
  s->request(request::ExportSession{out.path("session")});
  ASSERT_EQ(s->view()->message, "");
  EXPECT_THAT(debug(*s).notice,
              ::testing::AllOf(HasSubstr("8 frames"), ::testing::Not(HasSubstr("another one"))));

  // It opens where it was not written.
  fs::rename(out.path("session"), out.path("elsewhere"));
  const OpenedRun run = open_run(out.path("elsewhere"));
  EXPECT_EQ(run.no_images, "");
  EXPECT_EQ(run.recorded->hash, hash);
  SessionOptions options;
  options.recorded = run.recorded;
  options.sidecar = SidecarPlaces{out.path("elsewhere"), {}};
  Session other(run.source, run.recorded->run.config, options);
  other.request(request::GoTo{3});
  EXPECT_EQ(other.view()->message, "");
  EXPECT_EQ(other.view()->debug.run_hash, hash);
  EXPECT_THAT(other.view()->debug.bookmarks, ElementsAre(Bookmark{2, "look"}));
  other.request(request::Preview{config_});
  ASSERT_NE(other.view()->debug.preview, nullptr);
  EXPECT_TRUE(computed_alike(*other.view()->debug.preview->record, *other.view()->current->record));

  s->request(request::ExportSession{out.path("elsewhere")});
  EXPECT_THAT(s->view()->message, HasSubstr("elsewhere"));
}

TEST_F(SessionDebug, SavedPresetsAreRead) {
  const auto s = session();
  const TemporaryFolder out;
  config_.of<PaperConfig>().max_rounds = 2;
  s->request(request::SavePreset{config_, out.path("mine.toml")});
  EXPECT_EQ(read_config(out.path("mine.toml")), config_);
  s->request(request::SavePreset{config_, out.path("no/such/folder/mine.toml")});
  EXPECT_FALSE(s->view()->message.empty());
}

}  // namespace
}  // namespace stillpoint
