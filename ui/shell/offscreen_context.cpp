#include <fmt/format.h>

#include <cstdlib>
#include <string_view>

#include "core/error.hpp"
#include "ui/shell/graphics_context.hpp"

namespace stillpoint {

std::unique_ptr<GraphicsContext> make_offscreen_context(OffscreenBackend backend) {
  if (backend == OffscreenBackend::kAny) {
    const char* wish = std::getenv("STILLPOINT_OFFSCREEN");
    const std::string_view name = wish == nullptr ? "" : wish;
    if (name == "osmesa")
      backend = OffscreenBackend::kOsMesa;
    else if (name == "egl")
      backend = OffscreenBackend::kEgl;
    else if (!name.empty()) {
      throw InputError(fmt::format("STILLPOINT_OFFSCREEN is '{}', but only osmesa and egl are known", name));
    } else {
      backend = has_osmesa() ? OffscreenBackend::kOsMesa : OffscreenBackend::kEgl;
    }
  }
  return backend == OffscreenBackend::kOsMesa ? make_osmesa_context() : make_egl_context();
}

}  // namespace stillpoint
