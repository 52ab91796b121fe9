#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <dlfcn.h>

#include <string_view>

#include "core/error.hpp"
#include "ui/shell/graphics_context.hpp"

namespace stillpoint {
namespace {

/// libEGL's functions, loaded on first use: the program runs where EGL is not installed.
struct Egl {
  decltype(&eglGetProcAddress) GetProcAddress = nullptr;
  decltype(&eglQueryString) QueryString = nullptr;
  decltype(&eglInitialize) Initialize = nullptr;
  decltype(&eglBindAPI) BindAPI = nullptr;
  decltype(&eglChooseConfig) ChooseConfig = nullptr;
  decltype(&eglCreateContext) CreateContext = nullptr;
  decltype(&eglDestroyContext) DestroyContext = nullptr;
  decltype(&eglMakeCurrent) MakeCurrent = nullptr;
  EGLDisplay display = EGL_NO_DISPLAY;
};

template <typename Function>
void load(void* library, const char* name, Function& function) {
  function = reinterpret_cast<Function>(dlsym(library, name));
  if (function == nullptr) throw InputError(std::string("libEGL lacks the function ") + name);
}

Egl load_egl() {
  void* library = dlopen("libEGL.so.1", RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr)
    throw InputError("EGL is not installed (no libEGL.so.1), so nothing can be drawn offscreen");
  Egl egl;
  load(library, "eglGetProcAddress", egl.GetProcAddress);
  load(library, "eglQueryString", egl.QueryString);
  load(library, "eglInitialize", egl.Initialize);
  load(library, "eglBindAPI", egl.BindAPI);
  load(library, "eglChooseConfig", egl.ChooseConfig);
  load(library, "eglCreateContext", egl.CreateContext);
  load(library, "eglDestroyContext", egl.DestroyContext);
  load(library, "eglMakeCurrent", egl.MakeCurrent);
  const char* extensions = egl.QueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
  const auto get_platform_display =
      reinterpret_cast<PFNEGLGETPLATFORMDISPLAYEXTPROC>(egl.GetProcAddress("eglGetPlatformDisplayEXT"));
  if (extensions == nullptr || get_platform_display == nullptr ||
      std::string_view(extensions).find("EGL_MESA_platform_surfaceless") == std::string_view::npos) {
    throw InputError("this machine's EGL has no surfaceless platform, so nothing can be drawn offscreen");
  }
  egl.display = get_platform_display(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
  if (egl.display == EGL_NO_DISPLAY || egl.Initialize(egl.display, nullptr, nullptr) != EGL_TRUE) {
    throw InputError("EGL's surfaceless platform does not start on this machine");
  }
  return egl;
}

/// One display serves all contexts; it lives as long as the process.
const Egl& shared_egl() {
  static const Egl egl = load_egl();
  return egl;
}

class EglContext : public GraphicsContext {
 public:
  EglContext() : egl_(shared_egl()) {
    const EGLint config_attributes[] = {EGL_SURFACE_TYPE, 0, EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_NONE};
    const EGLint context_attributes[] = {EGL_CONTEXT_MAJOR_VERSION,
                                         3,
                                         EGL_CONTEXT_MINOR_VERSION,
                                         3,
                                         EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                         EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                         EGL_NONE};
    EGLConfig config = nullptr;
    EGLint count = 0;
    if (egl_.BindAPI(EGL_OPENGL_API) == EGL_TRUE &&
        egl_.ChooseConfig(egl_.display, config_attributes, &config, 1, &count) == EGL_TRUE && count > 0) {
      context_ = egl_.CreateContext(egl_.display, config, EGL_NO_CONTEXT, context_attributes);
    }
    if (context_ == EGL_NO_CONTEXT) throw InputError("EGL offers no OpenGL 3.3 core context on this machine");
  }
  ~EglContext() override {
    release_current();
    egl_.DestroyContext(egl_.display, context_);
  }

  void do_make_current() override {
    if (egl_.MakeCurrent(egl_.display, EGL_NO_SURFACE, EGL_NO_SURFACE, context_) != EGL_TRUE) {
      throw InputError("EGL's context cannot be made current without a surface");
    }
  }

  void do_release_current() override {
    egl_.MakeCurrent(egl_.display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  }

  [[nodiscard]] void* get_proc_address(const char* name) const override {
    return reinterpret_cast<void*>(egl_.GetProcAddress(name));
  }

  [[nodiscard]] std::string name() const override { return "EGL surfaceless"; }

 private:
  const Egl& egl_;
  EGLContext context_ = EGL_NO_CONTEXT;
};

}  // namespace

std::unique_ptr<GraphicsContext> make_egl_context() { return std::make_unique<EglContext>(); }

}  // namespace stillpoint
