#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/cli/run_cli.hpp"
#include "tests/cli/small_sequence.hpp"

namespace stillpoint {

/// What stands between two texts, the first time; empty where they do not.
inline std::string between(const std::string& text, const std::string& before, const std::string& after) {
  const std::size_t from = text.find(before);
  if (from == std::string::npos) return {};
  const std::size_t begin = from + before.size(), end = text.find(after, begin);
  return end == std::string::npos ? std::string() : text.substr(begin, end - begin);
}

/// A square that a mask made elsewhere takes for dynamic, in every frame but the first.
inline void write_masks(const SmallSequence& sequence, int frames) {
  for (int i = 1; i < frames; ++i) {
    cv::Mat mask(SmallSequence::kHeight, SmallSequence::kWidth, CV_8UC1, cv::Scalar(0));
    mask(cv::Rect(40 + 4 * i, 60, 80, 80)).setTo(255);
    sequence.folder.write(fmt::format("masks/{}.png", i), mask);
  }
}

/// Two runs of a small sequence, one of whose images is none, and reports of them.
class LiveReportExample : public ::testing::Test {
 protected:
  static constexpr int kFrames = 10, kUnreadable = 6;

  LiveReportExample() {
    write_masks(sequence_, kFrames);
    sequence_.folder.write(SmallSequence::colour(kUnreadable), std::string("no image"));
    for (const char* method : {"none", "stillpoint"}) {
      std::vector<std::string> arguments = {"run",  sequence_.path(), "--method",
                                            method, "--out",          run(method)};
      if (method != std::string("none"))
        arguments.insert(arguments.end(), {"--masks", sequence_.path("masks/")});
      const CliResult ran = run_cli(arguments);
      EXPECT_EQ(ran.exit_code, 0) << ran.err;
    }
  }

  [[nodiscard]] std::string run(const std::string& method) const { return sequence_.path("runs/" + method); }
  [[nodiscard]] CliResult report(const std::string& name, const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments = {"report",  run("none"), run("stillpoint"), "--interactive",
                                          "--worst", "1",         "--out",           sequence_.path(name)};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_cli(arguments);
  }
  [[nodiscard]] std::string page(const std::string& name) const { return sequence_.folder.read(name); }

  SmallSequence sequence_{kFrames};
};

}  // namespace stillpoint
