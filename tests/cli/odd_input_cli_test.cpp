// What a newcomer types that is not quite right: it is refused in a sentence, or told to be of no use;
// nothing crashes, and nothing is passed over in silence.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "tests/cli/run_cli.hpp"
#include "tests/cli/small_sequence.hpp"

namespace stillpoint {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using Words = std::vector<std::string>;

TEST(OddInput, NoNumberIsNan) {
  const SmallSequence sequence(3);
  const std::string place = sequence.path(), out = sequence.path("out");
  for (const Words& words :
       {Words{"run", place, "--depth-scale", "nan"}, Words{"run", place, "--depth-offset", "nan"},
        Words{"run", place, "--frame-rate", "nan"},
        Words{"snapshot", place, "--panels", "mask", "--out", out, "--scale", "nan"},
        Words{"snapshot", place, "--panels", "mask", "--video", out + ".avi", "--fps", "nan"},
        Words{"figures", place, "--frame", "1", "--out", out, "--scale", "nan"},
        Words{"export", place, "--dense", out + ".ply", "--voxel", "nan"},
        Words{"import", place, sequence.path("groundtruth.txt"), "--out", out, "--time-offset", "nan"},
        Words{"evaluate", place, sequence.path("groundtruth.txt"), "--frame-rate", "nan"},
        Words{"report", place, "--out", out, "--interactive", "--picture-mb", "nan"}}) {
    const CliResult result = run_cli(words);
    EXPECT_EQ(result.exit_code, 2) << words[0] << ": " << result.err;
    EXPECT_FALSE(result.by_signal);
    EXPECT_THAT(result.err, HasSubstr("Value nan not in range")) << words[0];
  }
  EXPECT_EQ(run_cli({"run", place, "--method", "none", "--depth-scale", "5e3", "--depth-offset", "-0.001"})
                .exit_code,
            0);
}

TEST(OddInput, AFinishedRunInASequencesPlaceIsNamed) {
  const SmallSequence sequence(3);
  const std::string run = sequence.path("run");
  ASSERT_EQ(run_cli({"run", sequence.path(), "--method", "none", "--out", run}).exit_code, 0);
  for (const Words& words :
       {Words{"run", run}, Words{"check", run}, Words{"benchmark", run, "--methods", "none"},
        Words{"export", run, "--out", sequence.path("x")},
        Words{"import", run, sequence.path("groundtruth.txt"), "--out", sequence.path("x")}})
    expect_one_sentence(run_cli(words), "is a finished run, and a sequence is wanted here");
  // A sequence in which somebody left a summary of their own is one all the same.
  sequence.folder.write("summary.json", std::string("{}"));
  EXPECT_EQ(run_cli({"run", sequence.path(), "--method", "none"}).exit_code, 0);
}

TEST(OddInput, SwitchesOfNoUseAreTold) {
  const SmallSequence sequence(3);
  const CliResult pairs = run_cli({"run", sequence.path(), "--method", "none", "--stereo", "size=half"});
  EXPECT_EQ(pairs.exit_code, 0) << pairs.err;
  EXPECT_THAT(pairs.err, HasSubstr("--stereo is of no use here: it goes with stereo pairs"));
  const CliResult generated = run_cli({"run", "generated:room", "--frames", "2", "--method", "none",
                                       "--truth", "inverse", "--depth-scale", "1000"});
  EXPECT_EQ(generated.exit_code, 0) << generated.err;
  EXPECT_THAT(generated.err, HasSubstr("--truth is of no use here: it goes with recorded sequences"));
  EXPECT_THAT(generated.err, HasSubstr("--depth-scale is of no use here"));
  EXPECT_THAT(run_cli({"run", "generated:room", "--frames", "2", "--method", "none", "--seed", "2"}).err,
              Not(HasSubstr("of no use")));
}

TEST(OddInput, APageWithoutTablesHasNone) {
  const TemporaryFolder folder("page");
  folder.write("page.md", std::string("# A page\n"));
  EXPECT_THAT(run_cli({"tables", folder.path("page.md")}).out, HasSubstr("page.md: has no marked table"));
}

TEST(OddInput, AScaleIsNotReadFromAFewFrames) {
  const CliResult few = run_cli({"run", "generated:room", "--frames", "3", "--method", "none"});
  EXPECT_EQ(few.exit_code, 0) << few.err;
  EXPECT_THAT(few.out, Not(HasSubstr("multiplied by")));
}

TEST(OddInput, ARotationThatPositionsDoNotTellIsTold) {
  // Along a line, with errors as large as what lies beside it: the estimate's world may be turned about it.
  const TemporaryFolder folder("line");
  std::ofstream truth(folder.path("truth.txt")), estimate(folder.path("estimate.txt"));
  for (int i = 0; i < 40; ++i) {
    const double t = i / 30.0, error = 0.01 * (i % 2 == 0 ? 1 : -1);
    truth << fmt::format("{:.4f} {:.5f} {:.5f} 0 0 0 0 1\n", t, 0.02 * i, 0.001 * (i % 3));
    // Errors below which the line's own unevenness, turned by half a turn, is lost.
    estimate << fmt::format("{:.4f} {:.5f} {:.5f} {:.5f} 0 0 0 1\n", t, 0.02 * i, -0.001 * (i % 3) + error,
                            0.001 * (i % 5));
  }
  truth.close(), estimate.close();
  const CliResult result = run_cli({"evaluate", folder.path("truth.txt"), folder.path("estimate.txt")});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.err, HasSubstr("do not tell the rotation about it"));
  EXPECT_THAT(run_cli({"evaluate", folder.path("truth.txt"), folder.path("truth.txt")}).err,
              Not(HasSubstr("do not tell the rotation")));
}

}  // namespace
}  // namespace stillpoint
