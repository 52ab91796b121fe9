#include "core/run/frame_records.hpp"

#include <array>
#include <cstring>
#include <mutex>
#include <type_traits>

#include "core/byte_store.hpp"
#include "core/run/frame_scores.hpp"
#include "core/run/record_codec.hpp"
#include "core/run/tracked_poses.hpp"

namespace stillpoint {
namespace {

/// What records.bin does not hold of a record: what was measured of it (its engine tells), parts of the
/// times, and the other half of the covariance, which is symmetric but for rounding.
template <typename Archive, typename Record>
void transfer_the_rest(Archive& archive, Record& r) {
  auto& parts = r.measured;
  for (auto* part : {&parts.mask, &parts.rounds, &parts.features, &parts.matches, &parts.solving,
                     &parts.direct, &parts.keyframes, &parts.culled_keyframes, &parts.points,
                     &parts.fused_points, &parts.bundle, &parts.times})
    archive(*part);
  for (auto* ms : {&r.ms.epnp, &r.ms.consensus, &r.ms.refine, &r.ms.direct}) archive(*ms);
  for (int row = 1; row < 6; ++row)
    for (int column = 0; column < row; ++column) archive(r.pose_covariance(row, column));
}

/// Chunks in a store: those asked for last are at hand.
template <typename T>
class StoredChunks : public ChunkKeeper<T> {
 public:
  using Chunk = typename ChunkKeeper<T>::Chunk;
  using Kept = typename ChunkKeeper<T>::Kept;

  explicit StoredChunks(std::shared_ptr<ByteStore> store) : store_(std::move(store)) {}

  [[nodiscard]] Kept put(const Chunk& chunk) override {
    const std::vector<std::uint8_t> bytes = pack(chunk);
    return {std::make_shared<const StoredBytes>(store_->put(bytes.data(), bytes.size()))};
  }
  [[nodiscard]] std::shared_ptr<const Chunk> get(Kept& kept) override {
    const std::lock_guard lock(mutex_);
    if (std::shared_ptr<const Chunk> there = kept.lately.lock()) return there;
    std::vector<std::uint8_t> bytes(kept.bytes->size());
    kept.bytes->read(bytes.data());
    auto chunk = std::make_shared<const Chunk>(unpack(bytes));
    kept.lately = chunk;
    at_hand_[next_] = chunk;
    next_ = (next_ + 1) % at_hand_.size();
    return chunk;
  }
  [[nodiscard]] std::size_t bytes_in_memory(const Kept& kept) const override {
    return sizeof(StoredBytes) + kept.bytes->bytes_in_memory();
  }

 private:
  [[nodiscard]] virtual std::vector<std::uint8_t> pack(const Chunk& chunk) const = 0;
  [[nodiscard]] virtual Chunk unpack(const std::vector<std::uint8_t>& bytes) const = 0;

  std::shared_ptr<ByteStore> store_;
  std::mutex mutex_;  // guards what follows
  // One that is walked, its neighbour, and another walk's.
  std::array<std::shared_ptr<const Chunk>, 4> at_hand_;
  std::size_t next_ = 0;
};

class RecordKeeper final : public StoredChunks<FrameRecord> {
 public:
  using StoredChunks::StoredChunks;

 private:
  [[nodiscard]] std::vector<std::uint8_t> pack(const Chunk& chunk) const override {
    ByteStreamWriter to;
    for (const FrameRecord& record : chunk) {
      write_record(to, record);
      transfer_the_rest(to, record);
    }
    return to.bytes();
  }
  [[nodiscard]] Chunk unpack(const std::vector<std::uint8_t>& bytes) const override {
    ByteStreamReader from(bytes);
    Chunk chunk;
    chunk.reserve(FrameRecords::kChunk);
    while (!from.empty()) transfer_the_rest(from, chunk.emplace_back(read_record(from)));
    return chunk;
  }
};

/// Elements as they lie in memory.
template <typename T>
class PlainKeeper final : public StoredChunks<T> {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  using StoredChunks<T>::StoredChunks;
  using Chunk = typename StoredChunks<T>::Chunk;

 private:
  [[nodiscard]] std::vector<std::uint8_t> pack(const Chunk& chunk) const override {
    std::vector<std::uint8_t> bytes(chunk.size() * sizeof(T));
    std::memcpy(bytes.data(), chunk.data(), bytes.size());
    return bytes;
  }
  [[nodiscard]] Chunk unpack(const std::vector<std::uint8_t>& bytes) const override {
    Chunk chunk(bytes.size() / sizeof(T));
    std::memcpy(chunk.data(), bytes.data(), bytes.size());
    return chunk;
  }
};

}  // namespace

FrameRecords records_put_by(const std::shared_ptr<ByteStore>& store, Outlines outlines) {
  std::shared_ptr<ChunkKeeper<FrameOutline>> keeper;
  if (outlines == Outlines::put_by) keeper = std::make_shared<PlainKeeper<FrameOutline>>(store);
  return {std::make_shared<RecordKeeper>(store), std::move(keeper)};
}

ScoreList scores_put_by(std::shared_ptr<ByteStore> store) {
  return ScoreList(std::make_shared<PlainKeeper<FrameScores>>(std::move(store)));
}

TrackedPoses poses_put_by(std::shared_ptr<ByteStore> store) {
  return TrackedPoses(std::make_shared<PlainKeeper<TrackedPose>>(std::move(store)));
}

}  // namespace stillpoint
