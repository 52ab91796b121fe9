#pragma once

#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <string>
#include <vector>

#include "tests/support/places.hpp"
#include "tests/unit/temporary_folder.hpp"

namespace stillpoint {

struct CliResult {
  int exit_code = -1;      ///< 128 + signal when a signal ended it, as a shell tells
  bool by_signal = false;  ///< a signal ended it; it did not exit by itself
  std::string out;         ///< standard output
  std::string err;         ///< standard error
};

/// The built program, started with these arguments as a user would.
class CliProcess {
 public:
  /// @param standard_output where it goes instead of into the result; empty = into the result
  explicit CliProcess(const std::vector<std::string>& arguments,
                      const std::string& program = places::program(),
                      const std::string& standard_output = "") {
    const std::string out = standard_output.empty() ? folder_.path("out") : standard_output,
                      err = folder_.path("err");
    std::vector<std::string> words = {program};
    words.insert(words.end(), arguments.begin(), arguments.end());
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    child_ = ::fork();
    if (child_ != 0) return;
    const int flags = O_WRONLY | O_CREAT | O_TRUNC;
    ::dup2(::open("/dev/null", O_RDONLY), STDIN_FILENO);
    ::dup2(::open(out.c_str(), flags, 0600), STDOUT_FILENO);
    ::dup2(::open(err.c_str(), flags, 0600), STDERR_FILENO);
    ::execv(argv[0], argv.data());
    ::_exit(127);
  }

  [[nodiscard]] pid_t id() const { return child_; }
  void send(int signal) const { ::kill(child_, signal); }

  /// Waits for its end.
  [[nodiscard]] CliResult wait() {
    CliResult result;
    int status = 0;
    if (child_ < 0 || ::waitpid(child_, &status, 0) != child_) {
      ADD_FAILURE() << "the program could not be started";
      return result;
    }
    result.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    result.by_signal = WIFSIGNALED(status);
    result.out = folder_.read("out");
    result.err = folder_.read("err");
    return result;
  }

 private:
  TemporaryFolder folder_;
  pid_t child_ = -1;
};

/// Runs the built program to its end.
inline CliResult run_cli(const std::vector<std::string>& arguments) { return CliProcess(arguments).wait(); }

/// Expects a run that failed as bad input should: exit status 1, nothing on standard output, and one line on
/// standard error that holds `part`.
inline void expect_one_sentence(const CliResult& result, const std::string& part) {
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_EQ(result.out, "");
  EXPECT_EQ(result.err.rfind("stillpoint: ", 0), 0U) << result.err;
  EXPECT_NE(result.err.find(part), std::string::npos) << result.err;
  EXPECT_EQ(result.err.find('\n'), result.err.size() - 1) << result.err;
}

/// Expects a command line that is wrong by itself: exit status 2, nothing on standard output, a sentence that
/// holds `part`, and where to read on.
inline void expect_usage_error(const CliResult& result, const std::string& part) {
  EXPECT_EQ(result.exit_code, 2) << result.err;
  EXPECT_EQ(result.out, "");
  EXPECT_NE(result.err.find(part), std::string::npos) << result.err;
  EXPECT_NE(result.err.find("Run with --help for more information."), std::string::npos) << result.err;
}

}  // namespace stillpoint
