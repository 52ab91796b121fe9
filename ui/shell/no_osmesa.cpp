#include "core/error.hpp"
#include "ui/shell/graphics_context.hpp"

namespace stillpoint {

bool has_osmesa() { return false; }

std::unique_ptr<GraphicsContext> make_osmesa_context() {
  throw InputError("this build has no OSMesa; choose EGL with STILLPOINT_OFFSCREEN=egl");
}

}  // namespace stillpoint
