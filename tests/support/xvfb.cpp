#include "tests/support/xvfb.hpp"

#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <cstdlib>

namespace stillpoint::testing {

Xvfb::Xvfb(const std::vector<std::string>& arguments) {
  const char* before = std::getenv("DISPLAY");
  display_before_ = before == nullptr ? "" : before;
  std::array<int, 2> channel{};
  if (::pipe(channel.data()) != 0) return;
  std::vector<std::string> words{
      "Xvfb", "-displayfd", std::to_string(channel[1]), "-screen", "0", "1600x1200x24", "-nolisten", "tcp"};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  pid_ = ::fork();
  if (pid_ == 0) {
    ::close(channel[0]);
    if (::freopen("/dev/null", "w", stderr) != nullptr) ::execvp("Xvfb", argv.data());
    ::_exit(127);
  }
  ::close(channel[1]);
  // The server writes its display's number once it takes connections, or closes the pipe by ending.
  std::string number;
  for (char letter = 0; ::read(channel[0], &letter, 1) == 1 && letter != '\n';) number += letter;
  ::close(channel[0]);
  if (number.empty()) {
    ::waitpid(pid_, nullptr, 0);
    pid_ = -1;
    return;
  }
  ::setenv("DISPLAY", (":" + number).c_str(), 1);
}

Xvfb::~Xvfb() {
  if (pid_ <= 0) return;
  ::kill(pid_, SIGTERM);
  ::waitpid(pid_, nullptr, 0);
  if (display_before_.empty())
    ::unsetenv("DISPLAY");
  else
    ::setenv("DISPLAY", display_before_.c_str(), 1);
}

}  // namespace stillpoint::testing
