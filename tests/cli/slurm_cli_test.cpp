// Benchmarks as job arrays: what Slurm is asked for, by stand-ins of its commands; and Slurm itself, on one
// node.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <thread>

#include "tests/cli/job_results.hpp"
#include "tests/cli/run_cli.hpp"
#include "tests/cli/small_sequence.hpp"
#include "tests/support/places.hpp"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::Not;

/// An environment variable, for as long as this lives.
class Variable {
 public:
  Variable(const char* name, const std::string& value) : name_(name) {
    if (const char* before = std::getenv(name)) before_ = before;
    ::setenv(name, value.c_str(), 1);
  }
  ~Variable() {
    if (before_)
      ::setenv(name_, before_->c_str(), 1);
    else
      ::unsetenv(name_);
  }
  Variable(const Variable&) = delete;
  Variable& operator=(const Variable&) = delete;

 private:
  const char* name_;
  std::optional<std::string> before_{};
};

/// Stand-ins of Slurm's commands: what they are asked goes into `asked`, and arrays have three tasks at most.
class StandIns : public ::testing::Test {
 protected:
  StandIns() {
    const std::string asked = " \"$@\" >>" + bin_.path("asked") + "\n";
    write("sbatch", "echo sbatch" + asked + "[[ ! -e " + bin_.path("refusal") + " ]] || { cat " +
                        bin_.path("refusal") + " >&2; exit 1; }\nwc -l <" + bin_.path("asked") + "\n");
    write("scontrol", "echo 'SlurmctldPort = 6817'; echo 'MaxArraySize            = 3'\n");
    write("squeue", "cat " + bin_.path("queue") + " 2>/dev/null || true\n");
  }

  void write(const std::string& name, const std::string& text) const {
    bin_.write(name, "#!/bin/bash\n" + text);
    fs::permissions(bin_.path(name), fs::perms::owner_all);
  }
  std::string read(const std::string& name) const { return sequence_.folder.read(name); }
  std::vector<std::string> words(const std::vector<std::string>& more = {}) const {
    std::vector<std::string> all = {"benchmark", sequence_.path(), "--methods", "none,epipolar", "--repeat",
                                    "2",         "--out",          out_,        "--slurm"};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
  /// Runs a script as a task of an array.
  static CliResult run_task(const std::string& script, int task) {
    const Variable number("SLURM_ARRAY_TASK_ID", std::to_string(task)), job("SLURM_ARRAY_JOB_ID", "1");
    return CliProcess({script}, "/bin/bash").wait();
  }

  SmallSequence sequence_{40};
  std::string out_ = sequence_.path("out");
  TemporaryFolder bin_{"bin"};
  Variable path_{"PATH", bin_.path() + ":" + std::getenv("PATH")};
};

TEST_F(StandIns, AnArrayIsSubmittedAndThenAJobThatMerges) {
  const CliResult result =
      run_cli(words({"--mem", "800M", "--time", "1:30:10", "--sbatch=--partition=long"}));
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("4 cells in 2 tasks submitted as Slurm's job 1; job 2 merges them"));
  EXPECT_EQ(bin_.read("asked"), "sbatch --parsable " + out_ + "/jobs/1.sbatch\n" +
                                    "sbatch --parsable --dependency=afterany:1 " + out_ +
                                    "/jobs/1.merge.sbatch\n");
  EXPECT_EQ(read("out/jobs/1.tasks"), "0,1\n2,3\n") << "as many cells a task as MaxArraySize asks for";
  EXPECT_EQ(read("out/jobs/1.submitted"), "1\n2\n");
  const std::string script = read("out/jobs/1.sbatch");
  for (const char* head :
       {"#!/bin/bash\n", "\n#SBATCH --job-name=stillpoint-benchmark\n", "\n#SBATCH --array=0-1\n",
        "\n#SBATCH --mem=800M\n", "\n#SBATCH --time=182\n", "\n#SBATCH --cpus-per-task=2\n",
        "\n#SBATCH --requeue\n", "\n#SBATCH --open-mode=append\n", "\n#SBATCH --partition=long\n"})
    EXPECT_THAT(script, HasSubstr(head));
  EXPECT_THAT(script, HasSubstr("\n#SBATCH --output=" + out_ + "/jobs/1_%a.log\n"));
  EXPECT_THAT(read("out/jobs/1.merge.sbatch"), HasSubstr("\n#SBATCH --mem=800M\n"));
  EXPECT_FALSE(fs::exists(out_ + "/results.json"));
}

TEST_F(StandIns, TasksRunTheirCellsOnceAndTheMergeNamesWhatIsMissing) {
  ASSERT_EQ(run_cli(words()).exit_code, 0);
  const CliResult task = run_task(out_ + "/jobs/1.sbatch", 1);
  ASSERT_EQ(task.exit_code, 0) << task.err;
  EXPECT_THAT(read("out/cells/000002.log"), HasSubstr("Slurm job 1_1, attempt 1"));
  const CliResult half = CliProcess({out_ + "/jobs/1.merge.sbatch"}, "/bin/bash").wait();
  EXPECT_EQ(half.exit_code, 1);
  EXPECT_THAT(half.out, HasSubstr("Of 4 runs, 2 have no result:"));
  EXPECT_THAT(half.out, HasSubstr("has not begun"));
  // Requeued: it finds its cells finished.
  const std::string record = read("out/cells/000002.json");
  const CliResult again = run_task(out_ + "/jobs/1.sbatch", 1);
  EXPECT_EQ(again.exit_code, 0);
  EXPECT_EQ(again.err, "");
  EXPECT_EQ(read("out/cells/000002.json"), record);

  // While a job is queued nothing is submitted; then only what is missing is.
  bin_.write("queue", std::string("7\n1\n"));
  expect_one_sentence(run_cli(words({"--resume"})), "Slurm's job 1 for it is still queued or running");
  bin_.write("queue", std::string("7\n"));
  ASSERT_EQ(run_cli(words({"--resume"})).exit_code, 0);
  EXPECT_EQ(read("out/jobs/2.tasks"), "0\n1\n");
  EXPECT_THAT(read("out/jobs/2.sbatch"), HasSubstr("--output=" + out_ + "/jobs/2_%a.log"));
  for (const int number : {0, 1}) EXPECT_EQ(run_task(out_ + "/jobs/2.sbatch", number).exit_code, 0);
  const CliResult merged = CliProcess({out_ + "/jobs/2.merge.sbatch"}, "/bin/bash").wait();
  EXPECT_EQ(merged.exit_code, 0) << merged.err;

  ASSERT_EQ(run_cli({"benchmark", sequence_.path(), "--methods", "none,epipolar", "--repeat", "2", "--out",
                     sequence_.path("one")})
                .exit_code,
            0);
  EXPECT_EQ(results_but_times(sequence_.folder, "out/results.json"),
            results_but_times(sequence_.folder, "one/results.json"));
  // Nothing is missing: nothing is submitted, and the tables are printed.
  const std::string asked = bin_.read("asked");
  const CliResult whole = run_cli(words({"--resume"}));
  EXPECT_EQ(whole.exit_code, 0);
  EXPECT_THAT(whole.out, HasSubstr("| RPE 1 s, RMSE [m] |"));
  EXPECT_EQ(bin_.read("asked"), asked);
}

TEST_F(StandIns, ATaskOfAPlanThatWasMadeAnewRunsNothing) {
  ASSERT_EQ(run_cli(words()).exit_code, 0);
  ASSERT_EQ(run_cli(words({"--force", "--set", "features.count=400"})).exit_code, 0);
  expect_one_sentence(run_task(out_ + "/jobs/1.sbatch", 0), "is not the one that this job was made for");
  EXPECT_EQ(files_that_end(out_ + "/cells", ".log"), 0);
}

TEST_F(StandIns, WhatSlurmRefusesIsToldInASentence) {
  bin_.write(
      "refusal",
      std::string(
          "sbatch: error: invalid partition specified: long\nsbatch: error: Batch job submission failed\n"));
  expect_one_sentence(
      run_cli(words()),
      "sbatch refuses: sbatch: error: invalid partition specified: long sbatch: error: Batch");
  write("sbatch", "case $* in *afterany*) echo no more >&2; exit 1 ;; esac\necho 5\n");
  expect_one_sentence(run_cli(words({"--force"})),
                      "sbatch refuses: no more; the runs are submitted as job 5");
  write("sbatch", "echo hello\n");
  expect_one_sentence(run_cli(words({"--force"})), "sbatch names no job, but says: 'hello");
  write("scontrol", "echo 'MaxArraySize = 0'\n");
  expect_one_sentence(run_cli(words({"--force"})), "allows no job arrays");
  fs::remove(bin_.path("scontrol"));
  {
    const Variable nowhere("PATH", bin_.path());
    expect_one_sentence(run_cli(words({"--force"})), "there is no scontrol here");
    std::vector<std::string> elsewhere = words();
    elsewhere[7] = sequence_.path("elsewhere");
    expect_one_sentence(run_cli(elsewhere), "there is no scontrol here");
    EXPECT_FALSE(fs::exists(elsewhere[7])) << "nothing is left that the next would take for results";
  }
  std::vector<std::string> odd = words();
  odd[7] = sequence_.path("100 %");
  expect_one_sentence(run_cli(odd), "--slurm wants an out folder whose path is of letters, digits");
  for (const std::vector<std::string>& bad : {std::vector<std::string>{"--time", "soon"},
                                              {"--time", "0"},
                                              {"--mem", "0"},
                                              {"--mem", "4 GB"},
                                              {"--jobs", "2"},
                                              {"--sbatch", "partition=long"}})
    EXPECT_EQ(run_cli(words(bad)).exit_code, 2) << bad[0] << " " << bad[1];
}

/// Debian's Slurm, with one node on the loopback interface, in a folder of its own.
class RealSlurm : public ::testing::Test {
 protected:
  void SetUp() override {
    const CliResult started = node("start");
    if (started.exit_code == 77) GTEST_SKIP() << "no Slurm can be started here: " << started.err;
    ASSERT_EQ(started.exit_code, 0) << started.err;
    conf_.emplace("SLURM_CONF", cluster_.path("slurm.conf"));
  }
  void TearDown() override { (void)node("stop"); }

  CliResult node(const std::string& what) const {
    return CliProcess({places::source() + "/tests/support/slurm_node", what, cluster_.path()}, "/bin/bash")
        .wait();
  }
  static CliResult shell(const std::string& line) { return CliProcess({"-c", line}, "/bin/bash").wait(); }
  std::string read(const std::string& name) const { return sequence_.folder.read(name); }

  bool comes(const std::function<bool()>& there) const {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(120);
    while (!there()) {
      if (std::chrono::steady_clock::now() > end) {
        ADD_FAILURE() << shell("squeue; scontrol show job; tail -n 30 " + cluster_.path("slurmctld.log")).out;
        return false;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(200));
    }
    return true;
  }
  bool queue_is_empty() const {
    const CliResult queue = shell("squeue --noheader");
    return queue.exit_code == 0 && queue.out.empty();
  }

  TemporaryFolder cluster_{"cluster"};
  std::optional<Variable> conf_{};
  SmallSequence sequence_{40};
};

TEST_F(RealSlurm, RunsAnArrayThroughARequeueAndAFailureAndGoesOn) {
  const std::string out = sequence_.path("out");
  sequence_.write_lists(200);
  sequence_.folder.write("out/sequence/epipolar", std::string("in the way"));
  std::vector<std::string> words = {"benchmark", sequence_.path(),
                                    "--methods", "none,epipolar",
                                    "--repeat",  "2",
                                    "--out",     out,
                                    "--slurm",   "--mem",
                                    "400M",      "--time",
                                    "5",         "--sbatch=--cpus-per-task=1"};
  const CliResult submitted = run_cli(words);
  ASSERT_EQ(submitted.exit_code, 0) << submitted.err;
  EXPECT_THAT(submitted.out, HasSubstr("4 cells in 2 tasks")) << "MaxArraySize is 3 there";
  // The first task is put back into the queue while its second cell runs.
  ASSERT_TRUE(comes([&] { return fs::exists(out + "/cells/000001.log"); }));
  const std::string first = read("out/cells/000000.json"), job = read("out/jobs/1.submitted").substr(0, 1);
  EXPECT_NE(first, "");
  ASSERT_EQ(shell("scontrol requeue " + job + "_0").exit_code, 0);
  ASSERT_TRUE(comes([&] { return queue_is_empty(); }));
  EXPECT_EQ(read("out/cells/000000.json"), first) << "what was finished is not run again";
  EXPECT_THAT(read("out/cells/000001.log"),
              HasSubstr("_0, attempt 1, whose own log is " + out + "/jobs/1_0.log"));
  EXPECT_THAT(read("out/cells/000001.log"), HasSubstr("_0, attempt 2"));
  EXPECT_THAT(read("out/jobs/1_0.log"), HasSubstr("DUE TO JOB REQUEUE"))
      << "the requeue left the log as it was";
  EXPECT_THAT(read("out/jobs/1_0.log"), HasSubstr("[1/1] sequence (features, none, repeat 1): done"));
  EXPECT_THAT(shell("scontrol show job " + job + "_1").out, HasSubstr("CPUs/Task=1 "))
      << "one's own options have the last word";
  // The job that merges came after all of them, and names the cell that failed.
  EXPECT_THAT(read("out/jobs/1.merge.log"), HasSubstr("Of 4 runs, 1 has no result:"));
  EXPECT_THAT(read("out/jobs/1.merge.log"), HasSubstr("cells/000002.log"));
  EXPECT_THAT(shell("scontrol show job " + std::to_string(std::stoi(job) + 1)).out,
              HasSubstr("ExitCode=1:0"));

  fs::remove(sequence_.path("out/sequence/epipolar"));
  words.push_back("--resume");
  const CliResult resumed = run_cli(words);
  ASSERT_EQ(resumed.exit_code, 0) << resumed.err;
  EXPECT_THAT(resumed.out, HasSubstr("1 cell in 1 task "));
  ASSERT_TRUE(comes([&] { return queue_is_empty(); }));
  EXPECT_THAT(read("out/jobs/2.merge.log"), Not(HasSubstr("no result")));
  words.resize(6);
  words.insert(words.end(), {"--out", sequence_.path("one")});
  ASSERT_EQ(run_cli(words).exit_code, 0);
  EXPECT_EQ(results_but_times(sequence_.folder, "out/results.json"),
            results_but_times(sequence_.folder, "one/results.json"));
}

}  // namespace
}  // namespace stillpoint
