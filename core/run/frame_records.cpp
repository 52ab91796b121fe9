#include "core/run/frame_records.hpp"

#include <cstring>
#include <type_traits>

#include "core/run/record_codec.hpp"

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

class RecordKeeper final : public ChunkKeeper<FrameRecord> {
 public:
  using ChunkKeeper::ChunkKeeper;

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

class ScoreKeeper final : public ChunkKeeper<FrameScores> {
 public:
  using ChunkKeeper::ChunkKeeper;

 private:
  static_assert(std::is_trivially_copyable_v<FrameScores>);
  [[nodiscard]] std::vector<std::uint8_t> pack(const Chunk& chunk) const override {
    std::vector<std::uint8_t> bytes(chunk.size() * sizeof(FrameScores));
    std::memcpy(bytes.data(), chunk.data(), bytes.size());
    return bytes;
  }
  [[nodiscard]] Chunk unpack(const std::vector<std::uint8_t>& bytes) const override {
    Chunk chunk(bytes.size() / sizeof(FrameScores));
    std::memcpy(chunk.data(), bytes.data(), bytes.size());
    return chunk;
  }
};

}  // namespace

FrameRecords records_put_by(std::shared_ptr<ByteStore> store) {
  return FrameRecords(std::make_shared<RecordKeeper>(std::move(store)));
}

ScoreList scores_put_by(std::shared_ptr<ByteStore> store) {
  return ScoreList(std::make_shared<ScoreKeeper>(std::move(store)));
}

}  // namespace stillpoint
