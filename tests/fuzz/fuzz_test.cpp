// Every target of the fuzzer over valid files, and over these cut short and altered: what no compiler but
// clang is needed for. Altered by a fixed generator, so that a failure comes again.
#include <gtest/gtest.h>

#include <atomic>
#include <random>

#include "tests/fuzz/targets.hpp"
#include "tests/support/allocations.hpp"

namespace stillpoint::fuzz {
namespace {

constexpr std::size_t kCuts = 40, kAltered = 120;  // of each valid file

std::atomic<std::size_t> largest_block{0};
void note_block(std::size_t bytes) {
  if (bytes > largest_block) largest_block = bytes;
}

/// One to four bytes are others, or a stretch is gone or there twice.
std::string altered(std::string bytes, std::mt19937& generator) {
  const auto below = [&](std::size_t count) { return generator() % std::max<std::size_t>(1, count); };
  const std::size_t at = below(bytes.size());
  switch (below(4)) {
    case 0:
      return bytes.erase(at, 1 + below(16));
    case 1:
      return bytes.insert(at, bytes.substr(at, 1 + below(64)));
    default:
      for (std::size_t left = 1 + below(4); left-- > 0 && !bytes.empty();)
        bytes[below(bytes.size())] = static_cast<char>(below(3) == 0 ? 0xFF : below(256));
      return bytes;
  }
}

class Parser : public ::testing::TestWithParam<Target> {
 protected:
  void SetUp() override { watch_large_allocations(note_block); }
  void TearDown() override { watch_large_allocations(nullptr); }

  /// Whether it takes an input, within its bound of memory.
  static bool takes(std::string_view input) {
    largest_block = 0;
    bool taken = false;
    EXPECT_NO_THROW(taken = accepts(GetParam(), input)) << "of " << input.size() << " bytes";
    EXPECT_LE(largest_block, GetParam().bound.of(input.size())) << "of " << input.size() << " bytes";
    return taken;
  }
};

TEST_P(Parser, TakesValidFiles) {
  for (const std::string& seed : GetParam().seeds()) EXPECT_TRUE(takes(seed)) << seed.substr(0, 80);
}

TEST_P(Parser, RefusesDamagedFilesInASentence) {
  std::mt19937 generator(1);
  std::size_t refused = 0;
  for (const std::string& seed : GetParam().seeds()) {
    for (std::size_t i = 0; i < kCuts; ++i)
      refused += takes(std::string_view(seed).substr(0, i * seed.size() / kCuts)) ? 0 : 1;
    for (std::size_t i = 0; i < kAltered; ++i) refused += takes(altered(seed, generator)) ? 0 : 1;
  }
  EXPECT_GT(refused, 0U) << "nothing was damaged";
}

INSTANTIATE_TEST_SUITE_P(Fuzz, Parser, ::testing::ValuesIn(targets()),
                         [](const auto& target) { return std::string(target.param.name); });

}  // namespace
}  // namespace stillpoint::fuzz
