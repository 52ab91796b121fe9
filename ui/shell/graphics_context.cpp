#include "ui/shell/graphics_context.hpp"

#include <fmt/format.h>

#include <cstdlib>
#include <string_view>

#include "core/error.hpp"

namespace stillpoint {
namespace {

/// The context that this thread draws with.
thread_local GraphicsContext* current_context = nullptr;

}  // namespace

void GraphicsContext::make_current() {
  if (current_context == this) return;
  if (current_context != nullptr) current_context->release_current();
  do_make_current();
  current_context = this;
}

void GraphicsContext::release_current() {
  if (current_context != this) return;
  do_release_current();
  current_context = nullptr;
}

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
