// Benchmarks and ablations whose runs are processes of their own.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "tests/cli/job_results.hpp"
#include "tests/cli/run_cli.hpp"
#include "tests/cli/small_sequence.hpp"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::Not;

using Words = std::vector<std::string>;

Words with_words(Words words, const Words& more) {
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

/// Waits until `there` holds. @returns whether it does
template <typename There>
bool comes(There there, int seconds = 60) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(seconds);
  while (!there()) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return true;
}

/// The process that runs a cell of this folder; 0 where there is none.
pid_t process_of_cell(const std::string& folder, int cell) {
  for (const auto& entry : fs::directory_iterator("/proc")) {
    const std::string name = entry.path().filename();
    if (name.find_first_not_of("0123456789") != std::string::npos) continue;
    std::ifstream file(entry.path() / "cmdline", std::ios::binary);
    const std::string line((std::istreambuf_iterator<char>(file)), {});
    if (line.find(folder + '\0') != std::string::npos &&
        line.ends_with("--inside" + std::string(1, '\0') + std::to_string(cell) + '\0'))
      return std::stoi(name);
  }
  return 0;
}

TEST(Jobs, ABenchmarksResultsAreThoseOfOneProcess) {
  const SmallSequence sequence(40);
  fs::copy(sequence.path(), sequence.path("../twin"), fs::copy_options::recursive);
  const Words words = {"benchmark",
                       sequence.path(),
                       sequence.path("../twin"),
                       "--methods",
                       "none,epipolar",
                       "--repeat",
                       "2",
                       "--frames",
                       "35",
                       "--run",
                       "truth=" + sequence.path("groundtruth.txt")};
  ASSERT_EQ(run_cli(with_words(words, {"--out", sequence.path("one")})).exit_code, 0);
  const CliResult jobs = run_cli(with_words(words, {"--out", sequence.path("jobs"), "--jobs", "2"}));
  ASSERT_EQ(jobs.exit_code, 0) << jobs.err;
  EXPECT_THAT(jobs.err, HasSubstr("[8/8] "));
  EXPECT_EQ(results_but_times(sequence.folder, "jobs/results.json"),
            results_but_times(sequence.folder, "one/results.json"));
  EXPECT_THAT(sequence.folder.read("jobs/results.json"), HasSubstr("\"rpe_m\": 0."));
  for (const char* table : {"table1.csv", "table1.md", "repeats.md", "repeats.csv"})
    EXPECT_EQ(sequence.folder.read(std::string("jobs/") + table),
              sequence.folder.read(std::string("one/") + table));
  for (const char* file : {"trajectory.txt", "config.toml", "map.ply"})
    for (const std::string& name : {std::string("sequence/none/"), std::string("twin/epipolar/")})
      EXPECT_EQ(sequence.folder.read("jobs/" + name + file), sequence.folder.read("one/" + name + file))
          << name << file;
  EXPECT_EQ(files_that_end(sequence.path("jobs/cells"), ".json"), 8);

  // Merged again, the same; and cells can be looked at one by one.
  const std::string before = sequence.folder.read("jobs/results.json");
  ASSERT_EQ(run_cli({"merge", sequence.path("jobs")}).exit_code, 0);
  EXPECT_EQ(sequence.folder.read("jobs/results.json"), before);
  EXPECT_EQ(run_cli({"cells", sequence.path("jobs"), "--inside", "3"}).exit_code, 0);
}

TEST(Jobs, EachEngineHasItsCells) {
  const SmallSequence sequence(6);
  const Words words = {"benchmark", sequence.path(), "--methods", "none", "--odometry", "features,ptam"};
  ASSERT_EQ(run_cli(with_words(words, {"--out", sequence.path("one")})).exit_code, 0);
  ASSERT_EQ(run_cli(with_words(words, {"--out", sequence.path("jobs"), "--jobs", "2"})).exit_code, 0);
  EXPECT_EQ(results_but_times(sequence.folder, "jobs/results.json"),
            results_but_times(sequence.folder, "one/results.json"));
  EXPECT_EQ(sequence.folder.read("jobs/table1_ptam.csv"), sequence.folder.read("one/table1_ptam.csv"));
  EXPECT_THAT(sequence.folder.read("jobs/results.json"), HasSubstr("\"odometry\": \"ptam\""));
}

TEST(Jobs, AnAblationsResultsAreThoseOfOneProcess) {
  const SmallSequence sequence(36);
  const Words words = {"ablate", sequence.path(), "--without", "prior,huber"};
  ASSERT_EQ(run_cli(with_words(words, {"--out", sequence.path("one")})).exit_code, 0);
  const Words by_jobs = with_words(words, {"--out", sequence.path("jobs"), "--jobs", "2"});
  const CliResult jobs = run_cli(by_jobs);
  ASSERT_EQ(jobs.exit_code, 0) << jobs.err;
  EXPECT_EQ(results_but_times(sequence.folder, "jobs/ablation.json"),
            results_but_times(sequence.folder, "one/ablation.json"));
  EXPECT_THAT(sequence.folder.read("jobs/ablation.json"), HasSubstr("\"set\": ["));

  // One ingredient more: what is there is not run again.
  Words more = with_words(words, {"--out", sequence.path("jobs"), "--resume"});
  more[3] = "prior,huber,smoother";
  const CliResult resumed = run_cli(more);
  ASSERT_EQ(resumed.exit_code, 0) << resumed.err;
  EXPECT_THAT(resumed.err, HasSubstr("[1/1] sequence (features, stillpoint, without smoother): done"));
  EXPECT_THAT(resumed.out, HasSubstr("without smoother"));
  EXPECT_EQ(nlohmann::json::parse(sequence.folder.read("jobs/ablation.json")).at("variants").size(), 4U);
}

TEST(Jobs, ACellThatFailsFailsByItselfAndIsNamed) {
  const SmallSequence sequence(6);
  const std::string out = sequence.path("out");
  // Where the second method's run is to be kept there is a file.
  sequence.folder.write("out/sequence/epipolar", std::string("in the way"));
  const Words words = {"benchmark", sequence.path(), "--methods", "none,epipolar,paper", "--out",
                       out,         "--jobs",        "2"};
  const CliResult failed = run_cli(words);
  EXPECT_EQ(failed.exit_code, 1);
  EXPECT_THAT(failed.err, HasSubstr("sequence (features, epipolar): failed with exit status 1, see " + out +
                                    "/cells/000001.log"));
  EXPECT_THAT(failed.out, HasSubstr("Of 3 runs, 1 has no result:"));
  for (const std::string& text :
       {failed.out, sequence.folder.read("out/table1.md"), sequence.folder.read("out/details.md")}) {
    EXPECT_THAT(text, HasSubstr("| exit status 1 |"));
    EXPECT_THAT(text, HasSubstr("cells/000001.log"));
    EXPECT_THAT(text, HasSubstr("is a file, where a folder for the results is wanted"));
  }
  auto results = nlohmann::json::parse(sequence.folder.read("out/results.json"));
  EXPECT_EQ(results.at("runs").size(), 2U);
  EXPECT_EQ(results.at("missing").at(0).at("status"), 1);
  EXPECT_EQ(results.at("missing").at(0).at("method"), "epipolar");
  EXPECT_THAT(sequence.folder.read("out/cells/000001.log"),
              HasSubstr("where a folder for the results is wanted"));

  // Mended and gone on with: it alone is run.
  fs::remove(sequence.path("out/sequence/epipolar"));
  const CliResult resumed = run_cli(with_words(words, {"--resume"}));
  EXPECT_EQ(resumed.exit_code, 0) << resumed.err;
  EXPECT_THAT(resumed.err, HasSubstr("[1/1] sequence (features, epipolar): done"));
  EXPECT_THAT(resumed.err, Not(HasSubstr("paper")));
  results = nlohmann::json::parse(sequence.folder.read("out/results.json"));
  EXPECT_EQ(results.at("runs").size(), 3U);
  EXPECT_EQ(results.at("runs").at(1).at("method"), "epipolar") << "in the plan's order";
  EXPECT_FALSE(results.contains("missing"));
}

TEST(Jobs, ACellThatCrashesIsToldByItsSignal) {
  const SmallSequence sequence(6);
  sequence.write_lists(400);
  const std::string out = sequence.path("out");
  CliProcess process({"benchmark", sequence.path(), "--methods", "none,paper", "--frames", "400", "--out",
                      out, "--jobs", "1"});
  pid_t cell = 0;
  ASSERT_TRUE(comes([&] { return (cell = process_of_cell(out, 0)) != 0; }));
  ::kill(cell, SIGSEGV);
  // What the rest would take is not waited for.
  ASSERT_TRUE(comes([&] { return process_of_cell(out, 1) != 0; }));
  process.send(SIGINT);
  const CliResult result = process.wait();
  EXPECT_EQ(result.exit_code, 128 + SIGINT);
  EXPECT_THAT(result.out, HasSubstr("exit status 139 (signal 11)"));
  EXPECT_THAT(result.out, HasSubstr("has not ended"));
  EXPECT_EQ(process_of_cell(out, 1), 0) << "nothing runs on";
}

TEST(Jobs, KilledLeavesNoCellRunningAndGoesOn) {
  const SmallSequence sequence(6);
  sequence.write_lists(100);
  const std::string out = sequence.path("out");
  const Words words = {"benchmark", sequence.path(), "--methods", "none,epipolar", "--out",
                       out,         "--jobs",        "1"};
  CliProcess process(words);
  ASSERT_TRUE(comes([&] { return process_of_cell(out, 1) != 0; }));
  process.send(SIGKILL);
  (void)process.wait();
  EXPECT_TRUE(comes([&] { return process_of_cell(out, 1) == 0; }, 10));
  EXPECT_FALSE(fs::exists(out + "/results.json"));
  EXPECT_FALSE(fs::exists(out + "/cells/000001.json"));
  const CliResult resumed = run_cli(with_words(words, {"--resume"}));
  EXPECT_EQ(resumed.exit_code, 0) << resumed.err;
  EXPECT_THAT(resumed.err, HasSubstr("[1/1] sequence (features, epipolar): done"));
  EXPECT_EQ(nlohmann::json::parse(sequence.folder.read("out/results.json")).at("runs").size(), 2U);
}

TEST(Jobs, ForceRunsAnewWhatTheSamePlanHas) {
  const SmallSequence sequence(4);
  for (const Words& words : {Words{"benchmark", sequence.path(), "--methods", "none"},
                             Words{"ablate", sequence.path(), "--without", "prior"}}) {
    const std::string out = sequence.path(words[0]);
    ASSERT_EQ(run_cli(with_words(words, {"--out", out, "--jobs", "1"})).exit_code, 0);
    const CliResult forced = run_cli(with_words(words, {"--out", out, "--jobs", "1", "--force"}));
    ASSERT_EQ(forced.exit_code, 0) << forced.err;
    EXPECT_THAT(forced.err, HasSubstr("runs are to be made, 1 at a time"));
  }
}

TEST(Jobs, StoppedKeepsWhatWasFinishedAndGoesOn) {
  const SmallSequence sequence(40), longer(6);
  longer.write_lists(2000);
  const std::string out = sequence.path("out");
  fs::rename(longer.path(), sequence.path("../longer"));
  const Words words = {"benchmark", sequence.path(), sequence.path("../longer"), "--methods", "none", "--out",
                       out};
  CliProcess process(with_words(words, {"--jobs", "2"}));
  ASSERT_TRUE(comes([&] { return files_that_end(out + "/cells", ".json") == 1; }));
  process.send(SIGTERM);
  const CliResult stopped = process.wait();
  EXPECT_EQ(stopped.exit_code, 128 + SIGTERM) << stopped.err;
  EXPECT_THAT(stopped.err, HasSubstr("stillpoint: stopped early; --resume goes on"));
  EXPECT_EQ(process_of_cell(out, 1), 0);
  const auto kept = nlohmann::json::parse(sequence.folder.read("out/results.json"));
  ASSERT_EQ(kept.at("runs").size(), 1U);
  EXPECT_EQ(kept.at("runs").at(0).at("sequence"), "sequence");

  // Gone on with in one process, too; of the longer one the first frames do.
  fs::rename(sequence.path("../longer"), longer.path());
  longer.write_lists(30);
  fs::rename(longer.path(), sequence.path("../longer"));
  const CliResult resumed = run_cli(with_words(words, {"--resume"}));
  ASSERT_EQ(resumed.exit_code, 0) << resumed.err;
  EXPECT_THAT(resumed.err, Not(HasSubstr("sequence (none)")));
  const auto results = nlohmann::json::parse(sequence.folder.read("out/results.json"));
  ASSERT_EQ(results.at("runs").size(), 2U);
  EXPECT_EQ(results.at("runs").at(0), kept.at("runs").at(0));
  EXPECT_FALSE(fs::exists(out + "/plan.json")) << "the folder is one process' again";
}

TEST(Jobs, ResumeAndMergeRefuseWhatIsOfAnotherBuildOrOtherSettings) {
  const SmallSequence sequence(4);
  const std::string out = sequence.path("out");
  const Words words = {"benchmark", sequence.path(), "--methods", "none", "--out", out, "--jobs", "1"};
  ASSERT_EQ(run_cli(words).exit_code, 0);
  expect_one_sentence(run_cli(words), "--force");
  const Words resume = with_words(words, {"--resume"});
  expect_one_sentence(run_cli(with_words(resume, {"--set", "features.count=300"})),
                      "was made with other parameters");
  expect_one_sentence(run_cli(with_words(resume, {"--depth-scale", "1000"})), "read otherwise");
  expect_one_sentence(run_cli({"ablate", sequence.path(), "--out", out, "--jobs", "1", "--resume"}),
                      "its plan.json is of `benchmark`");
  expect_one_sentence(run_cli({"cells", out, "--only", "0", "--plan", "0000000000000000"}),
                      "is not the one that this job was made for");
  expect_one_sentence(run_cli({"cells", out, "--inside", "7"}), "has cells 0 to 0, and no 7");
  const std::string record = sequence.folder.read("out/cells/000000.json"),
                    plan = sequence.folder.read("out/plan.json");
  sequence.folder.write("out/cells/000000.json",
                        std::string(record).replace(record.find("\"commit\":\"") + 10, 3, "zzz"));
  expect_one_sentence(run_cli({"merge", out}), "was made by another build (commit zzz");
  sequence.folder.write("out/cells/000000.json", record);
  sequence.folder.write("out/plan.json",
                        std::string(plan).replace(plan.find("\"commit\": \"") + 11, 3, "zzz"));
  for (const Words& again : {Words{"merge", out}, Words{"cells", out, "--only", "0"},
                             Words{"cells", out, "--inside", "0"}, resume})
    expect_one_sentence(run_cli(again), "plan.json was made by another build (commit zzz");
  sequence.folder.write("out/plan.json", std::string("{}"));
  expect_one_sentence(run_cli({"merge", out}), "plan.json: is no plan of cells");
  expect_one_sentence(run_cli({"merge", sequence.path()}), "holds no plan.json");
  EXPECT_EQ(run_cli({"benchmark", sequence.path(), "--jobs", "2"}).exit_code, 2) << "--out is needed";
}

TEST(BenchmarkForce, TheEarlierResultsStayUntilTheNewOnesAreWhole) {
  const SmallSequence sequence(6);
  const std::string out = sequence.path("out");
  const Words words = {"benchmark", sequence.path(), "--methods", "none,epipolar", "--out", out};
  ASSERT_EQ(run_cli(with_words(words, {"--frames", "6"})).exit_code, 0);
  const std::string before = sequence.folder.read("out/results.json"),
                    table = sequence.folder.read("out/table1.csv");
  sequence.write_lists(120);
  // Killed after its first run, in one process and as jobs.
  for (const Words& how : {Words{}, Words{"--jobs", "1"}}) {
    CliProcess process(with_words(with_words(words, {"--force"}), how));
    const std::string first = how.empty() ? "out/results.new.json" : "out/cells/000000.json";
    ASSERT_TRUE(comes([&] { return fs::exists(sequence.path(first)); }));
    process.send(how.empty() ? SIGKILL : SIGTERM);
    (void)process.wait();
    EXPECT_EQ(sequence.folder.read("out/results.json"), before);
    EXPECT_EQ(sequence.folder.read("out/table1.csv"), table);
    const CliResult resumed = run_cli(with_words(with_words(words, {"--resume"}), how));
    ASSERT_EQ(resumed.exit_code, 0) << resumed.err;
    EXPECT_THAT(resumed.err, Not(HasSubstr("(none)"))) << "the first run is not made again";
    EXPECT_THAT(resumed.err, Not(HasSubstr("features, none")));
    const auto runs = nlohmann::json::parse(sequence.folder.read("out/results.json")).at("runs");
    ASSERT_EQ(runs.size(), 2U);
    EXPECT_EQ(runs.at(0).at("frames"), 120);
    EXPECT_EQ(runs.at(1).at("frames"), 120);
    EXPECT_FALSE(fs::exists(sequence.path("out/results.new.json")));
    sequence.folder.write("out/results.json", before);
    sequence.folder.write("out/table1.csv", table);
  }
}

TEST(BenchmarkResume, RefusesResultsOfAnotherBuild) {
  const SmallSequence sequence(3);
  const Words words = {"benchmark", sequence.path(), "--methods", "none", "--out", sequence.path("out")};
  ASSERT_EQ(run_cli(words).exit_code, 0);
  auto results = nlohmann::ordered_json::parse(sequence.folder.read("out/results.json"));
  results["commit"] = "0123abcdef";
  const std::string altered = results.dump(2);
  sequence.folder.write("out/results.json", altered);
  for (const Words& how : {Words{"--resume"}, Words{"--resume", "--jobs", "2"}})
    expect_one_sentence(run_cli(with_words(words, how)), "was made by another build (commit 0123abcdef)");
  EXPECT_EQ(sequence.folder.read("out/results.json"), altered);
}

}  // namespace
}  // namespace stillpoint
