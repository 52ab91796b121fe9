#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

#include "core/sequence/bag/byte_reader.hpp"
#include "core/sequence/image_file.hpp"

namespace stillpoint {

/// How a chunk of messages is packed.
enum class Compression { none, bz2, lz4, zstd };

/// By the names that bags and MCAP files have for it ("", "none", "bz2", "lz4", "zstd").
/// @throws MalformedBytes for another
[[nodiscard]] Compression compression_by_name(std::string_view name);

/// No chunk is larger: a length that claims more is a damaged one.
inline constexpr std::uint64_t kLargestChunk = std::uint64_t{1} << 30;

/// The first `most` bytes of what is packed, or as many as the packed bytes hold: where they end too early,
/// what there is up to there. What is allocated grows with what comes out, whatever was claimed.
/// @throws MalformedBytes for bytes that are damaged at their very beginning, and for more than kLargestChunk
[[nodiscard]] Bytes decompress(Compression compression, ByteView packed, std::uint64_t most);

}  // namespace stillpoint
