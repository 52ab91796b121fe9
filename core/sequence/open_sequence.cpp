#include <string_view>

#include "core/sequence/generated/generated_sequence.hpp"
#include "core/sequence/source.hpp"
#include "core/sequence/tum_folder.hpp"

namespace stillpoint {

std::unique_ptr<FrameSource> open_sequence(const std::string& where, const OpenOptions& options) {
  constexpr std::string_view kGenerated = "generated:";
  if (where.starts_with(kGenerated))
    return make_generated_sequence(where.substr(kGenerated.size()), options.frames, options.seed);
  return std::make_unique<TumFolder>(where, options.camera);
}

}  // namespace stillpoint
