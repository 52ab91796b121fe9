#include <fmt/format.h>

#include <string_view>

#include "core/error.hpp"
#include "core/sequence/first_frames.hpp"
#include "core/sequence/generated/generated_sequence.hpp"
#include "core/sequence/source.hpp"
#include "core/sequence/tum_folder.hpp"

namespace stillpoint {

std::unique_ptr<FrameSource> open_sequence(const std::string& where, const OpenOptions& options) {
  constexpr std::string_view kGenerated = "generated:";
  if (where.starts_with(kGenerated))
    return make_generated_sequence(where.substr(kGenerated.size()), options.frames, options.seed);
  auto folder = std::make_unique<TumFolder>(where, options);
  if (options.frames < 0)
    throw InputError(fmt::format("{}: expected a number of frames, not {}", where, options.frames));
  if (options.frames == 0) return folder;
  return first_frames(std::move(folder), options.frames);
}

}  // namespace stillpoint
