#include "core/sequence/bag/chunked_log.hpp"

#include <algorithm>
#include <utility>

#include "core/text_file.hpp"

namespace stillpoint {
namespace {

constexpr std::uint64_t kMostKept = 96 << 20;  // bytes of unpacked chunks, beside the last one

}  // namespace

void ChunkedLog::set_topics(std::vector<std::pair<LoggedTopic, std::vector<Place>>> topics) {
  std::sort(topics.begin(), topics.end(),
            [](const auto& a, const auto& b) { return a.first.name < b.first.name; });
  for (auto& [topic, places] : topics) {
    topic.name = printable(std::move(topic.name)), topic.type = printable(std::move(topic.type));
    topic.encoding = printable(std::move(topic.encoding));
    std::stable_sort(places.begin(), places.end(),
                     [](const Place& a, const Place& b) { return a.time < b.time; });
    topic.times.reserve(places.size());
    for (const Place& place : places) topic.times.push_back(place.time);
    topics_.push_back(std::move(topic));
    places_.push_back(std::move(places));
  }
}

ChunkedLog::Unpacked ChunkedLog::unpacked(std::uint32_t index, std::uint64_t most) const {
  const Chunk& chunk = chunks_.at(index);
  bool again = false;
  {
    const std::lock_guard lock(mutex_);
    if (const auto kept = kept_.find(index); kept != kept_.end()) {
      if (kept->second->size() >= most || kept->second->size() >= chunk.unpacked_size) return kept->second;
      again = true;
    }
  }
  // The beginning alone is unpacked at first: a large image's stamp stands there. Who asks again has all.
  const Bytes packed = file_.read(chunk.offset, chunk.packed_size);
  auto bytes = std::make_shared<const Bytes>(decompress(
      chunk.compression, packed, again ? chunk.unpacked_size : std::min(most, chunk.unpacked_size)));
  const std::lock_guard lock(mutex_);
  auto& kept = kept_[index];
  if (kept) {
    kept_bytes_ -= kept->size();
    order_.erase(std::find(order_.begin(), order_.end(), index));
  }
  kept = bytes;
  kept_bytes_ += bytes->size();
  order_.push_back(index);
  while (kept_bytes_ > kMostKept && order_.size() > 1) {
    const auto oldest = kept_.find(order_.front());
    kept_bytes_ -= oldest->second->size();
    kept_.erase(oldest);
    order_.pop_front();
  }
  return bytes;
}

Bytes ChunkedLog::chunk_bytes(std::uint32_t index, std::uint64_t offset, std::uint64_t count) const {
  const Chunk& chunk = chunks_.at(index);
  if (chunk.compression == Compression::none) {
    if (offset >= chunk.packed_size) return {};
    return file_.read(chunk.offset + offset, std::min(count, chunk.packed_size - offset));
  }
  const std::uint64_t end = count > kLargestChunk ? kLargestChunk : offset + count;
  const Unpacked bytes = unpacked(index, end);
  if (offset >= bytes->size()) return {};
  const auto first = bytes->begin() + static_cast<std::ptrdiff_t>(offset);
  return {first, first + static_cast<std::ptrdiff_t>(std::min<std::uint64_t>(count, bytes->size() - offset))};
}

Bytes ChunkedLog::read(std::size_t topic, std::size_t message, std::size_t most) const {
  const Place& place = places_.at(topic).at(message);
  Bytes start = chunk_bytes(place.chunk, place.offset, kRecordStart);
  const auto [offset, size] = message_in(start);
  const std::uint64_t wanted = std::min<std::uint64_t>(most, size);
  if (offset + wanted <= start.size()) {
    const auto first = start.begin() + static_cast<std::ptrdiff_t>(offset);
    return {first, first + static_cast<std::ptrdiff_t>(wanted)};
  }
  Bytes bytes = chunk_bytes(place.chunk, place.offset + offset, wanted);
  if (bytes.size() < wanted) throw MalformedBytes("is truncated");
  return bytes;
}

}  // namespace stillpoint
