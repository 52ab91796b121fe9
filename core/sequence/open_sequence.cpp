#include <fmt/format.h>

#include <string_view>

#include "core/error.hpp"
#include "core/sequence/source.hpp"
#include "core/sequence/tum_folder.hpp"

#if __has_include("core/sequence/generated/generated_sequence.hpp")
#include "core/sequence/generated/generated_sequence.hpp"
#define STILLPOINT_HAS_GENERATED_SEQUENCES
#endif

namespace stillpoint {
namespace {

constexpr std::string_view kGenerated = "generated:";

std::unique_ptr<FrameSource> open_generated(const std::string& kind, const OpenOptions& options) {
#ifdef STILLPOINT_HAS_GENERATED_SEQUENCES
  return make_generated_sequence(kind, options.frames, options.seed);
#else
  (void)options;
  throw InputError(fmt::format("{}{}: this build has no generated sequences", kGenerated, kind));
#endif
}

}  // namespace

std::unique_ptr<FrameSource> open_sequence(const std::string& where, const OpenOptions& options) {
  if (where.starts_with(kGenerated)) return open_generated(where.substr(kGenerated.size()), options);
  return std::make_unique<TumFolder>(where, options.camera);
}

}  // namespace stillpoint
