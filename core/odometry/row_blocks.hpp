#pragma once

#include <algorithm>
#include <future>
#include <vector>

namespace stillpoint {

/// Sums over an image's rows, or any list: in a fixed number of blocks, each summed on its own, then added in
/// order. So any number of threads gives the same bytes.
/// @param sum of a block: `Sum sum(int first, int end)`; Sum has +=
template <typename Sum, typename OfBlock>
[[nodiscard]] Sum sum_in_blocks(int count, int threads, const OfBlock& of_block) {
  // Whatever the threads, so that sums are rounded alike; more than 16 threads help nothing.
  constexpr int kBlocks = 16;
  std::vector<Sum> sums(kBlocks);
  const auto work = [&](int from, int step) {
    for (int block = from; block < kBlocks; block += step)
      sums[static_cast<std::size_t>(block)] =
          of_block(count * block / kBlocks, count * (block + 1) / kBlocks);
  };
  const int workers = std::clamp(threads, 1, kBlocks);
  std::vector<std::future<void>> beside;
  for (int i = 1; i < workers; ++i) beside.push_back(std::async(std::launch::async, work, i, workers));
  work(0, workers);
  for (std::future<void>& one : beside) one.get();
  Sum all = std::move(sums.front());
  for (std::size_t i = 1; i < sums.size(); ++i) all += sums[i];
  return all;
}

}  // namespace stillpoint
