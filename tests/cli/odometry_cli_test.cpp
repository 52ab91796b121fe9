// --odometry: the second axis, as a user types it, and where runs name it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "tests/cli/csv_rows.hpp"
#include "tests/cli/run_cli.hpp"
#include "tests/unit/temporary_folder.hpp"

namespace stillpoint {
namespace {

using ::testing::HasSubstr;

TEST(Odometry, IsNamedWhereverTheMethodIs) {
  const TemporaryFolder folder;
  const std::string out = folder.path("run");
  const CliResult result = run_cli({"run", "generated:walking_static", "--frames", "6", "--odometry", "bamvo",
                                    "--method", "oracle", "--out", out});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("method oracle, odometry bamvo: 6 of 6 frames tracked"));
  EXPECT_THAT(folder.read("run/config.toml"), HasSubstr("odometry = \"bamvo\""));
  EXPECT_THAT(folder.read("run/config.toml"), HasSubstr("[bamvo]"));
  const auto summary = nlohmann::json::parse(folder.read("run/summary.json"));
  EXPECT_EQ(summary["odometry"], "bamvo");
  const auto rows = csv_rows(folder.read("run/frames.csv"));
  ASSERT_EQ(rows.size(), 6U);
  EXPECT_GT(std::stod(rows[5].at("bamvo_counted")), 0.1);
  EXPECT_EQ(rows[5].at("rms_px"), "");  // it measures brightness, and no pixels

  // The finished run is opened again by its engine, stages and all.
  const CliResult shown =
      run_cli({"snapshot", out, "--frames", "4", "--panels", "stages", "--out", folder.path("pictures")});
  EXPECT_EQ(shown.exit_code, 0) << shown.err;
  EXPECT_TRUE(std::filesystem::exists(folder.path("pictures/000004_stages.png")));
  // … and listed by what the engine measured.
  const CliResult told = run_cli({"run", "generated:walking_static", "--frames", "4", "--odometry", "bamvo",
                                  "--method", "none", "--break", "bamvo_counted > 1%"});
  EXPECT_EQ(told.exit_code, 3);
  EXPECT_THAT(told.out, HasSubstr("at 3 of 4 frames: 1-3"));
}

TEST(Odometry, APresetIsAWholeSystem) {
  for (const char* preset : {"bamvo", "dso", "ptam"}) {
    const CliResult result =
        run_cli({"run", "generated:walking_static", "--frames", "3", "--config", preset});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_THAT(result.out, HasSubstr("method none, odometry " + std::string(preset)));
  }
}

TEST(Odometry, HelpNamesTheEnginesAndAWrongOneIsRefused) {
  EXPECT_THAT(run_cli({"run", "--help"}).out, HasSubstr("features, bamvo, dso, ptam"));
  const CliResult wrong = run_cli({"run", "generated:room", "--odometry", "orbslam"});
  EXPECT_EQ(wrong.exit_code, 1);
  EXPECT_THAT(wrong.err, HasSubstr("run.odometry takes one of: features, bamvo, dso, ptam"));
}

TEST(Odometry, ABenchmarkHasATableAnEngineAndGainsOverTheSameEngine) {
  const TemporaryFolder folder;
  const CliResult result =
      run_cli({"benchmark", "generated:walking_static", "--frames", "5", "--methods", "none,oracle",
               "--odometry", "features,ptam", "--out", folder.path("table")});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("Odometry features\n"));
  EXPECT_THAT(result.out, HasSubstr("Odometry ptam\n"));
  for (const char* file :
       {"table1.md", "table1.csv", "table1_ptam.csv", "details.csv",
        "generated_walking_static/none/summary.json", "generated_walking_static/ptam/oracle/summary.json"})
    EXPECT_TRUE(std::filesystem::exists(folder.path(std::string("table/") + file))) << file;
  const auto rows = csv_rows(folder.read("table/details.csv"));
  ASSERT_EQ(rows.size(), 4U);
  EXPECT_EQ(rows[1].at("odometry"), "features");
  EXPECT_EQ(rows[3].at("odometry"), "ptam");
  EXPECT_EQ(rows[3].at("method"), "oracle");
  const CliResult twice = run_cli({"benchmark", "generated:room", "--odometry", "ptam,ptam"});
  EXPECT_EQ(twice.exit_code, 1);
  EXPECT_THAT(twice.err, HasSubstr("--odometry names ptam twice"));
}

}  // namespace
}  // namespace stillpoint
