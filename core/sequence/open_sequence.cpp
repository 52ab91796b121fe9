#include <fmt/format.h>

#include <string_view>

#include "core/error.hpp"
#include "core/sequence/first_frames.hpp"
#include "core/sequence/generated/generated_sequence.hpp"
#include "core/sequence/listed_sequence.hpp"
#include "core/sequence/source.hpp"

namespace stillpoint {
namespace {

std::unique_ptr<SequenceInput> open_input(const std::string& where, const OpenOptions& options) {
  return make_folder_input(open_folder(where), options);
}

}  // namespace

std::unique_ptr<FrameSource> open_sequence(const std::string& where, const OpenOptions& options) {
  constexpr std::string_view kGenerated = "generated:";
  if (where.starts_with(kGenerated))
    return make_generated_sequence(where.substr(kGenerated.size()), options.frames, options.seed);
  auto recorded = std::make_unique<ListedSequence>(open_input(where, options), options);
  if (options.frames < 0)
    throw InputError(fmt::format("{}: expected a number of frames, not {}", where, options.frames));
  if (options.frames == 0) return recorded;
  return first_frames(std::move(recorded), options.frames);
}

}  // namespace stillpoint
