#include <GL/osmesa.h>

#include <array>

#include "core/error.hpp"
#include "ui/shell/graphics_context.hpp"

namespace stillpoint {
namespace {

// Everything is drawn into framebuffer objects; OSMesa only wants some memory to call its own.
constexpr int kSide = 16;

class OsMesaContext : public GraphicsContext {
 public:
  OsMesaContext() {
    const int attributes[] = {OSMESA_FORMAT,
                              OSMESA_RGBA,
                              OSMESA_DEPTH_BITS,
                              24,
                              OSMESA_PROFILE,
                              OSMESA_CORE_PROFILE,
                              OSMESA_CONTEXT_MAJOR_VERSION,
                              3,
                              OSMESA_CONTEXT_MINOR_VERSION,
                              3,
                              0};
    context_ = OSMesaCreateContextAttribs(attributes, nullptr);
    if (context_ == nullptr) throw InputError("OSMesa offers no OpenGL 3.3 core context on this machine");
  }
  ~OsMesaContext() override {
    release_current();
    OSMesaDestroyContext(context_);
  }

  void do_make_current() override {
    if (OSMesaMakeCurrent(context_, pixels_.data(), GL_UNSIGNED_BYTE, kSide, kSide) != GL_TRUE) {
      throw InputError("OSMesa's context cannot be made current");
    }
  }

  void do_release_current() override { OSMesaMakeCurrent(nullptr, nullptr, 0, 0, 0); }

  [[nodiscard]] void* get_proc_address(const char* name) const override {
    return reinterpret_cast<void*>(OSMesaGetProcAddress(name));
  }

  [[nodiscard]] std::string name() const override { return "OSMesa"; }

 private:
  OSMesaContext context_ = nullptr;
  std::array<unsigned char, 4 * kSide * kSide> pixels_{};
};

}  // namespace

bool has_osmesa() { return true; }

std::unique_ptr<GraphicsContext> make_osmesa_context() { return std::make_unique<OsMesaContext>(); }

}  // namespace stillpoint
