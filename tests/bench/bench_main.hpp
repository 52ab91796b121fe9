#pragma once

#include <fmt/format.h>

#include <cstdio>
#include <exception>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "core/allocator.hpp"

namespace stillpoint {

/// What every bench that is given a sequence does in main(): it works as the program does, and ends with a
/// sentence where something is wrong.
/// @param usage "live_bench SEQUENCE [METHOD [FRAMES]]" @param work given the arguments, at least one
template <typename Work>
int bench_main(int argc, char** argv, const std::string& usage, Work work) {
  if (argc < 2) {
    fmt::print(stderr, "usage: {}\n", usage);
    return 2;
  }
  cv::setNumThreads(1);
  tune_allocator();
  try {
    work(std::vector<std::string>(argv + 1, argv + argc));
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}: {}\n", usage.substr(0, usage.find(' ')), error.what());
    return 1;
  }
  return 0;
}

/// Of benches that are given SEQUENCE [METHOD [FRAMES]]. @param measure (where, method, frames; 0 = all)
template <typename Measure>
int method_bench_main(int argc, char** argv, const std::string& name, Measure measure) {
  return bench_main(argc, argv, name + " SEQUENCE [METHOD [FRAMES]]",
                    [&measure](const std::vector<std::string>& words) {
                      measure(words[0], words.size() > 1 ? words[1] : "stillpoint",
                              words.size() > 2 ? std::stoi(words[2]) : 0);
                    });
}

}  // namespace stillpoint
