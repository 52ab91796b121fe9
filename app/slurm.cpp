#include "app/slurm.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sys/wait.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <regex>
#include <set>

#include "core/config.hpp"
#include "core/counted.hpp"
#include "core/error.hpp"
#include "core/out_folder.hpp"
#include "core/text_file.hpp"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;

constexpr const char* kJobsFolder = "jobs";

/// A word as the shell takes it.
std::string shell_word(const std::string& word) {
  return "'" + std::regex_replace(word, std::regex("'"), "'\\''") + "'";
}

struct Answer {
  int status = 0;
  std::string text;  ///< standard output and error
};

/// Runs a line of the shell.
Answer ask_shell(const std::string& line) {
  std::fflush(stdout);
  std::FILE* pipe = ::popen((line + " 2>&1").c_str(), "r");
  if (pipe == nullptr) throw InputError("--slurm: no process can be started");
  Answer answer;
  std::array<char, 4096> part{};
  while (const std::size_t count = std::fread(part.data(), 1, part.size(), pipe))
    answer.text.append(part.data(), count);
  const int status = ::pclose(pipe);
  answer.status = WIFEXITED(status) ? WEXITSTATUS(status) : 128;
  return answer;
}

/// What one of Slurm's commands answers.
/// @throws InputError with what it said, on one line
std::string ask_slurm(const std::string& command, const std::string& line) {
  Answer answer = ask_shell(line);
  constexpr int kNotFound = 127;  // what a shell answers for a command that is not there
  if (answer.status == kNotFound)
    throw InputError(fmt::format(
        "--slurm: there is no {} here; a cluster's jobs are submitted where Slurm's commands are", command));
  if (answer.status != 0) {
    while (!answer.text.empty() && answer.text.back() == '\n') answer.text.pop_back();
    std::replace(answer.text.begin(), answer.text.end(), '\n', ' ');
    throw InputError(fmt::format("--slurm: {} refuses: {}", command, printable(answer.text)));
  }
  return answer.text;
}

/// The number of a job that `sbatch --parsable` submits: its last line is "JOB" or "JOB;CLUSTER".
std::string submitted(const std::string& line) {
  const std::string text = ask_slurm("sbatch", line);
  static const std::regex number("(?:^|\n)([0-9]+)(;[^\n]*)?\n*$");
  std::smatch match;
  if (!std::regex_search(text, match, number))
    throw InputError(fmt::format("--slurm: sbatch names no job, but says: {}", in_quotes(text)));
  return match[1];
}

/// The most tasks that an array may have.
int max_array_size() {
  const std::string text = ask_slurm("scontrol", "scontrol show config");
  static const std::regex line("MaxArraySize *= *([0-9]+)");
  std::smatch match;
  const int size = std::regex_search(text, match, line) ? std::stoi(match[1]) : 0;
  if (size < 2)
    throw InputError("--slurm: this cluster allows no job arrays (MaxArraySize in scontrol show config)");
  return size;
}

/// Numbers of the submissions there are, in order.
std::vector<int> submissions(const fs::path& jobs) {
  std::set<int> numbers;
  std::error_code none;
  for (const fs::directory_entry& entry : fs::directory_iterator(jobs, none))
    if (entry.path().extension() == ".sbatch") numbers.insert(std::atoi(entry.path().filename().c_str()));
  return {numbers.begin(), numbers.end()};
}

/// The user's own options, which stand last, so that they have the last word.
std::string own_heads(const SlurmOptions& options) {
  std::string text;
  for (const std::string& other : options.others) text += fmt::format("#SBATCH {}\n", other);
  return text;
}

std::string this_program() { return shell_word(fs::read_symlink("/proc/self/exe").string()); }

/// @param threads of a cell
std::string array_script(const fs::path& folder, const CellPlan& plan, const SlurmOptions& options,
                         int number, std::size_t tasks, std::size_t cells_a_task, int threads) {
  return fmt::format(
      "#!/bin/bash\n"
      "#SBATCH --job-name=stillpoint-{kind}\n"
      "#SBATCH --array=0-{last}\n"
      "#SBATCH --mem={mem}\n"
      "#SBATCH --time={minutes}\n"
      "#SBATCH --cpus-per-task={threads}\n"
      "# A task that is preempted, or whose node is lost, begins anew: cells that have a result are not run "
      "again,\n"
      "# and logs go on where they were.\n"
      "#SBATCH --requeue\n"
      "#SBATCH --open-mode=append\n"
      "#SBATCH --output={jobs}/{number}_%a.log\n"
      "{own}"
      "exec {program} cells {folder} --plan {plan} \\\n"
      "  --only \"$(sed -n \"$((SLURM_ARRAY_TASK_ID + 1))p\" {jobs}/{number}.tasks)\"\n",
      fmt::arg("kind", plan.kind), fmt::arg("last", tasks - 1), fmt::arg("mem", options.mem),
      fmt::arg("minutes", slurm_minutes(options.time) * static_cast<int>(cells_a_task)),
      fmt::arg("threads", threads), fmt::arg("jobs", (folder / kJobsFolder).string()),
      fmt::arg("number", number), fmt::arg("own", own_heads(options)), fmt::arg("program", this_program()),
      fmt::arg("folder", folder.string()), fmt::arg("plan", plan.fingerprint()));
}

std::string merge_script(const fs::path& folder, const CellPlan& plan, const SlurmOptions& options,
                         int number) {
  return fmt::format(
      "#!/bin/bash\n"
      "#SBATCH --job-name=stillpoint-merge\n"
      "#SBATCH --mem={}\n"
      "#SBATCH --time=30\n"
      "#SBATCH --open-mode=append\n"
      "#SBATCH --output={}/{}.merge.log\n"
      "{}"
      "exec {} merge {} --plan {}\n",
      options.mem, (folder / kJobsFolder).string(), number, own_heads(options), this_program(),
      folder.string(), plan.fingerprint());
}

/// sbatch reads quotes, blanks, % and backslashes in the head of a script in ways of its own.
void throw_if_not_plain(const fs::path& folder) {
  static const std::regex plain("[A-Za-z0-9_./+,=@:-]+");
  if (!std::regex_match(folder.string(), plain))
    throw InputError(
        fmt::format("{}: --slurm wants an out folder whose path is of letters, digits and _./+,=@:- alone",
                    folder.string()));
}

}  // namespace

int slurm_minutes(const std::string& time) {
  static const std::regex forms("(?:([0-9]{1,4})-)?([0-9]{1,6})(?::([0-9]{1,2}))?(?::([0-9]{1,2}))?");
  std::smatch match;
  if (!std::regex_match(time, match, forms))
    throw InputError(
        fmt::format("--time {}: expected minutes, H:M:S or D-H:M:S, as Slurm writes it", in_quotes(time)));
  const auto part = [&match](std::size_t i) { return match[i].matched ? std::stoi(match[i]) : 0; };
  int seconds = 0;
  if (match[1].matched)
    seconds = ((part(1) * 24 + part(2)) * 60 + part(3)) * 60 + part(4);
  else if (match[4].matched)
    seconds = (part(2) * 60 + part(3)) * 60 + part(4);
  else
    seconds = part(2) * 60 + part(3);
  constexpr int kMinute = 60, kLongest = 366 * 24 * 60;  // s; minutes of a year
  const int minutes = (seconds + kMinute - 1) / kMinute;
  if (minutes < 1 || minutes > kLongest)
    throw InputError(fmt::format("--time {}: expected a minute to a year", in_quotes(time)));
  return minutes;
}

void throw_if_no_jobs(const fs::path& folder) {
  throw_if_not_plain(folder);
  (void)max_array_size();
}

void submit_cells(const fs::path& folder, const CellPlan& plan, const std::vector<int>& cells,
                  const SlurmOptions& options) {
  const auto largest = static_cast<std::size_t>(max_array_size());
  const std::size_t cells_a_task = (cells.size() + largest - 1) / largest;
  const std::size_t tasks = (cells.size() + cells_a_task - 1) / cells_a_task;
  const fs::path jobs = folder / kJobsFolder;
  std::error_code failed;
  fs::create_directories(jobs, failed);
  const std::vector<int> earlier = submissions(jobs);
  const int number = earlier.empty() ? 1 : earlier.back() + 1;
  std::string list;
  for (std::size_t first = 0; first < cells.size(); first += cells_a_task) {
    const auto begin = cells.begin() + static_cast<std::ptrdiff_t>(first);
    list += fmt::format(
        "{}\n",
        fmt::join(begin, begin + static_cast<std::ptrdiff_t>(std::min(cells_a_task, cells.size() - first)),
                  ","));
  }
  const int threads = config_from_toml(plan.config, kPlanName).run.threads;
  const fs::path array = jobs / fmt::format("{}.sbatch", number),
                 merge = jobs / fmt::format("{}.merge.sbatch", number);
  WholeFiles files;
  files.add(jobs / fmt::format("{}.tasks", number), list);
  files.add(array, array_script(folder, plan, options, number, tasks, cells_a_task, threads));
  files.add(merge, merge_script(folder, plan, options, number));
  files.keep();
  const std::string array_job = submitted("sbatch --parsable " + shell_word(array.string()));
  const fs::path numbers = jobs / fmt::format("{}.submitted", number);
  write_text_file(numbers, array_job + "\n");
  std::string merge_job;
  try {
    // afterany, for a cell that fails must not keep the others from being merged.
    merge_job = submitted(
        fmt::format("sbatch --parsable --dependency=afterany:{} {}", array_job, shell_word(merge.string())));
  } catch (const InputError& error) {
    throw InputError(
        fmt::format("{}; the runs are submitted as job {}, and `stillpoint merge {}` is left to do by hand",
                    error.what(), array_job, folder.string()));
  }
  write_text_file(numbers, array_job + "\n" + merge_job + "\n");
  fmt::print(
      "{} in {} submitted as Slurm's job {}; job {} merges them into {} when all have ended\n"
      "stillpoint merge {}   merges what there is so far, and names the cells that are missing\n",
      counted(cells.size(), "cell"), counted(tasks, "task"), array_job, merge_job, folder.string(),
      folder.string());
}

void throw_if_queued(const fs::path& folder) {
  std::set<std::string> ours;
  const fs::path jobs = folder / kJobsFolder;
  for (const int number : submissions(jobs)) {
    const fs::path path = jobs / fmt::format("{}.submitted", number);
    if (std::error_code none; !fs::exists(path, none)) continue;
    for (const TextLine& line : text_lines(read_text(path.string()))) ours.insert(line.text);
  }
  if (ours.empty()) return;
  // %F: an array's own number, for each of its tasks.
  const Answer queue = ask_shell("squeue --me --noheader --format=%F");
  if (queue.status != 0) return;  // nobody here can tell
  for (const TextLine& line : text_lines(queue.text))
    if (ours.count(line.text))
      throw InputError(
          fmt::format("{}: Slurm's job {} for it is still queued or running; wait for it, or scancel {}",
                      folder.string(), line.text, line.text));
}

}  // namespace stillpoint
