#include "core/byte_store.hpp"

#include <gtest/gtest.h>

#include <numeric>
#include <thread>
#include <vector>

namespace stillpoint::testing {
namespace {

std::vector<std::uint8_t> numbers(std::size_t count, int first) {
  std::vector<std::uint8_t> bytes(count);
  for (std::size_t i = 0; i < count; ++i)
    bytes[i] = static_cast<std::uint8_t>(i * 7 + static_cast<std::size_t>(first));
  return bytes;
}

std::vector<std::uint8_t> read_back(const StoredBytes& stored) {
  std::vector<std::uint8_t> bytes(stored.size());
  stored.read(bytes.data());
  return bytes;
}

TEST(ByteStoreTest, GivesBackWhatWasPutByInAnyOrder) {
  const auto store = ByteStore::make();
  std::vector<StoredBytes> stored;
  for (int i = 0; i < 50; ++i) {
    const auto bytes = numbers(static_cast<std::size_t>(1 + 997 * i), i);
    stored.push_back(store->put(bytes.data(), bytes.size()));
  }
  for (const int i : {49, 0, 20, 21, 3})
    EXPECT_EQ(read_back(stored[static_cast<std::size_t>(i)]),
              numbers(static_cast<std::size_t>(1 + 997 * i), i));
}

TEST(ByteStoreTest, ACopyOutlivesTheStore) {
  StoredBytes kept;
  {
    const auto store = ByteStore::make();
    const auto bytes = numbers(5000, 3);
    const StoredBytes stored = store->put(bytes.data(), bytes.size());
    kept = stored;
  }
  EXPECT_EQ(read_back(kept), numbers(5000, 3));
}

TEST(ByteStoreTest, NothingIsNothing) {
  const StoredBytes stored = ByteStore::make()->put(nullptr, 0);
  EXPECT_EQ(stored.size(), 0U);
  stored.read(nullptr);
}

TEST(ByteStoreTest, ManyThreadsAtOnce) {
  const auto store = ByteStore::make();
  std::vector<std::thread> threads;
  for (int thread = 0; thread < 4; ++thread)
    threads.emplace_back([&store, thread] {
      for (int i = 0; i < 100; ++i) {
        const auto bytes = numbers(3000, thread * 50 + i);
        EXPECT_EQ(read_back(store->put(bytes.data(), bytes.size())), bytes);
      }
    });
  for (std::thread& thread : threads) thread.join();
}

}  // namespace
}  // namespace stillpoint::testing
