#include "app/cell_processes.hpp"

#include <fcntl.h>
#include <fmt/chrono.h>
#include <fmt/format.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <fstream>
#include <thread>
#include <utility>

#include "app/cell_kinds.hpp"
#include "app/jobs.hpp"
#include "app/progress.hpp"
#include "app/version.hpp"
#include "core/error.hpp"
#include "core/text_file.hpp"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kHeading = "== ";

struct CellProcess {
  pid_t process = -1;
  int cell = 0;
  Stopwatch watch{};
};

std::string environment(const char* name) {
  const char* value = std::getenv(name);
  return value != nullptr ? value : "";
}

/// What a cell's log begins with, once an attempt. Slurm writes why it ended a task into a log of its own.
std::string heading(const PlanCell& cell) {
  char host[256] = {};
  (void)::gethostname(host, sizeof host - 1);
  std::string text = fmt::format("{}{:%Y-%m-%dT%H:%M:%SZ} on {}: {}", kHeading,
                                 fmt::gmtime(std::time(nullptr)), host, to_text(cell));
  if (const std::string job = environment("SLURM_ARRAY_JOB_ID"); !job.empty()) {
    std::error_code none;
    text += fmt::format("; Slurm job {}_{}, attempt {}, whose own log is {}", job,
                        environment("SLURM_ARRAY_TASK_ID"),
                        std::atoi(environment("SLURM_RESTART_COUNT").c_str()) + 1,
                        fs::read_symlink("/proc/self/fd/1", none).string());
  }
  return text + "\n";
}

/// Starts `stillpoint cells FOLDER --inside N` with its output in the cell's log, after what is there.
pid_t start_cell(const fs::path& folder, const CellPlan& plan, std::string fingerprint, int number) {
  const std::string log = (folder / cell_log_name(number)).string(), cell = std::to_string(number);
  const int file = ::open(log.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
  const std::string first = heading(plan.cells[static_cast<std::size_t>(number)]);
  if (file < 0 || ::write(file, first.data(), first.size()) != static_cast<ssize_t>(first.size())) {
    const int error = errno;
    if (file >= 0) ::close(file);
    throw InputError(fmt::format("{}: cannot be written ({})", log, std::strerror(error)));
  }
  std::string words[] = {"stillpoint", "cells", folder.string(), "--plan", fingerprint, "--inside", cell};
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  const int nothing = ::open("/dev/null", O_RDONLY | O_CLOEXEC);
  const pid_t parent = ::getpid(), child = ::fork();
  if (child == 0) {
    // Whoever waits for it may be killed: then it ends, too.
    ::prctl(PR_SET_PDEATHSIG, SIGTERM);
    if (::getppid() != parent) ::_exit(128 + SIGTERM);
    ::dup2(nothing, STDIN_FILENO);
    ::dup2(file, STDOUT_FILENO);
    ::dup2(file, STDERR_FILENO);
    ::execv("/proc/self/exe", argv.data());
    ::_exit(127);
  }
  const int error = errno;
  ::close(file), ::close(nothing);
  if (child < 0) throw InputError(fmt::format("a cell cannot be started ({})", std::strerror(error)));
  return child;
}

/// The last line of a log, clipped; empty where this attempt said nothing.
std::string last_words(const fs::path& log) {
  constexpr std::size_t kLongest = 300;  // bytes: a sentence for a table's cell
  std::string said;
  std::ifstream file(log);
  for (std::string line; std::getline(file, line);)
    if (!line.empty()) said = line;
  if (said.starts_with(kHeading)) return {};
  constexpr std::string_view kProgram = "stillpoint: ";
  if (said.starts_with(kProgram)) said.erase(0, kProgram.size());
  return printable(said.substr(0, kLongest));
}

/// Keeps how a cell ended whose process could not do so itself.
void keep_failure(const fs::path& folder, const std::string& fingerprint, int cell, int status) {
  const BenchmarkResults here = made_here();
  CellRecord record{cell, fingerprint, here.commit, here.machine, status};
  record.said = last_words(folder / cell_log_name(cell));
  write_record(folder, record);
}

std::string minutes_text(double ms) {
  const auto seconds = static_cast<int>(ms / 1000.0 + 0.5);
  return fmt::format("{}:{:02}:{:02}", seconds / 3600, seconds / 60 % 60, seconds % 60);
}

/// The cells that run, and those that wait for it.
class CellPool {
 public:
  CellPool(const fs::path& folder, const CellPlan& plan, const std::vector<int>& cells, int jobs,
           bool keeps_stopped)
      : folder_(folder),
        plan_(plan),
        cells_(cells),
        jobs_(static_cast<std::size_t>(std::max(1, jobs))),
        keeps_stopped_(keeps_stopped) {}
  /// Leaves none running, whatever was thrown.
  ~CellPool() {
    for (const CellProcess& one : running_) {
      ::kill(one.process, SIGKILL);
      ::waitpid(one.process, nullptr, 0);
    }
  }
  CellPool(const CellPool&) = delete;
  CellPool& operator=(const CellPool&) = delete;

  int run() {
    while (!running_.empty() || (next_ < cells_.size() && !stop_requested())) {
      while (running_.size() < jobs_ && next_ < cells_.size() && !stop_requested()) start(cells_[next_++]);
      if (stop_requested()) stop();
      if (!take_ended()) std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    return failed_;
  }

 private:
  void start(int cell) {
    std::error_code none;
    fs::remove(folder_ / cell_record_name(cell), none);  // of an attempt that failed
    running_.push_back({start_cell(folder_, plan_, fingerprint_, cell), cell, {}});
  }

  /// Hands the request on, once. A terminal and Slurm have sent the same signal to the cells already, and a
  /// second one of a kind would end them at once: they get the other one.
  void stop() {
    if (std::exchange(is_stopping_, true)) return;
    for (const CellProcess& one : running_)
      ::kill(one.process, stop_signal_given() == SIGINT ? SIGTERM : SIGINT);
  }

  /// @returns whether one has ended
  bool take_ended() {
    for (std::size_t i = 0; i < running_.size(); ++i) {
      int status = 0;
      if (::waitpid(running_[i].process, &status, WNOHANG) != running_[i].process) continue;
      const CellProcess ended = running_[i];
      running_.erase(running_.begin() + static_cast<std::ptrdiff_t>(i));
      tell(ended, WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status));
      return true;
    }
    return false;
  }

  void tell(const CellProcess& ended, int status) {
    std::error_code none;
    const bool has_record = fs::exists(folder_ / cell_record_name(ended.cell), none);
    if (status == 0 && !has_record) status = 1;
    if (status != 0 && stop_requested() && !keeps_stopped_) return;
    // Which signal handed the request on says nothing.
    if (stop_requested() && (status == 128 + SIGINT || status == 128 + SIGTERM))
      status = 128 + stop_signal_given();
    std::string how = "done";
    if (status != 0) {
      ++failed_;
      keep_failure(folder_, fingerprint_, ended.cell, status);
      how = fmt::format("failed with {}, see {}", exit_text(status),
                        (folder_ / cell_log_name(ended.cell)).string());
    }
    ++done_;
    const double left =
        watch_.milliseconds() / static_cast<double>(done_) * static_cast<double>(cells_.size() - done_);
    fmt::print(stderr, "[{}/{}] {}: {} in {}; {} left\n", done_, cells_.size(),
               to_text(plan_.cells[static_cast<std::size_t>(ended.cell)]), how,
               minutes_text(ended.watch.milliseconds()), minutes_text(left));
  }

  const fs::path& folder_;
  const CellPlan& plan_;
  const std::vector<int>& cells_;
  const std::string fingerprint_ = plan_.fingerprint();
  std::size_t jobs_, next_ = 0, done_ = 0;
  std::vector<CellProcess> running_;
  bool keeps_stopped_, is_stopping_ = false;
  int failed_ = 0;
  Stopwatch watch_;
};

}  // namespace

int run_cells(const fs::path& folder, const CellPlan& plan, const std::vector<int>& cells, int jobs,
              bool keeps_stopped) {
  if (!cells.empty())
    fmt::print(stderr, "{} of the plan's {} runs are to be made, {} at a time; each has a log in {}\n",
               cells.size(), plan.cells.size(), std::max(1, jobs),
               (folder / cell_log_name(0)).parent_path().string());
  return CellPool(folder, plan, cells, jobs, keeps_stopped).run();
}

void run_cell_here(const fs::path& folder, int cell, const std::string& fingerprint) {
  const CellPlan plan = plan_to_go_by(folder, fingerprint);
  if (cell < 0 || cell >= static_cast<int>(plan.cells.size()))
    throw InputError(fmt::format("{}: its plan has cells 0 to {}, and no {}", folder.string(),
                                 static_cast<int>(plan.cells.size()) - 1, cell));
  (void)stop_requested();
  const BenchmarkResults here = made_here();
  CellRecord record{cell, plan.fingerprint(), here.commit, here.machine};
  record.json = cell_kind(plan.kind).run(plan, plan.cells[static_cast<std::size_t>(cell)], folder);
  write_record(folder, record);
}

CellPlan plan_to_go_by(const fs::path& folder, const std::string& fingerprint) {
  CellPlan plan = read_plan(folder);
  throw_if_other_build(plan, made_here().commit, folder.string());
  if (!fingerprint.empty() && plan.fingerprint() != fingerprint)
    throw InputError(
        fmt::format("{}: its {} is not the one that this job was made for; it was planned anew since",
                    folder.string(), kPlanName));
  return plan;
}

}  // namespace stillpoint
