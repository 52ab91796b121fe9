#pragma once

#include <memory>
#include <string>

namespace stillpoint {

/// An OpenGL 3.3 core context, wherever it comes from. What is drawn with it without a display goes into
/// framebuffers of ui/gl, so a context needs no size of its own.
///
/// Contexts of several libraries live in one process, and none of these libraries knows of the others: each
/// believes its own context still current after another has taken its place. So the one before is released
/// first, here.
class GraphicsContext {
 public:
  GraphicsContext() = default;
  virtual ~GraphicsContext() = default;
  GraphicsContext(const GraphicsContext&) = delete;
  GraphicsContext& operator=(const GraphicsContext&) = delete;

  /// Makes it the calling thread's context.
  void make_current();

  /// Leaves the calling thread without a context if this is its context. Destructors of implementations call
  /// it.
  void release_current();

  /// The context's own entry point of a GL function, or null.
  [[nodiscard]] virtual void* get_proc_address(const char* name) const = 0;

  /// What made it: "OSMesa", "EGL surfaceless", "GLFW".
  [[nodiscard]] virtual std::string name() const = 0;

 private:
  virtual void do_make_current() = 0;
  virtual void do_release_current() = 0;
};

/// Ways to a context without a display.
enum class OffscreenBackend {
  kAny,     ///< OSMesa where it was built in, else EGL; the environment's STILLPOINT_OFFSCREEN=osmesa|egl
            ///< decides first
  kOsMesa,  ///< Mesa's software renderer, in process; gone from Mesa since 25.1
  kEgl,     ///< EGL's surfaceless platform, loaded at run time
};

/// A context without a display, not yet current.
/// @throws InputError when neither way works, saying why; or the one asked for does not.
[[nodiscard]] std::unique_ptr<GraphicsContext> make_offscreen_context(
    OffscreenBackend backend = OffscreenBackend::kAny);

/// Whether this build has OSMesa.
[[nodiscard]] bool has_osmesa();

// The two implementations. Each throws InputError when its way to a context is closed.
[[nodiscard]] std::unique_ptr<GraphicsContext> make_osmesa_context();
[[nodiscard]] std::unique_ptr<GraphicsContext> make_egl_context();

}  // namespace stillpoint
