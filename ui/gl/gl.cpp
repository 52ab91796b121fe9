#include "ui/gl/gl.hpp"

#include <fmt/format.h>

#include "core/error.hpp"

namespace stillpoint {
namespace {

constexpr int kOldestVersion = 33;  // OpenGL 3.3, as the shaders are written

template <typename Function>
Function lookup(const GetProcAddress& get_proc_address, const char* name) {
  return reinterpret_cast<Function>(get_proc_address(name));
}

void APIENTRY collect_message(GLenum /*source*/, GLenum type, GLuint /*id*/, GLenum /*severity*/,
                              GLsizei length, const GLchar* message, const void* user) {
  if (type != GL_DEBUG_TYPE_ERROR && type != GL_DEBUG_TYPE_UNDEFINED_BEHAVIOR) return;
  auto* messages = static_cast<std::vector<std::string>*>(const_cast<void*>(user));
  messages->emplace_back(
      message, length < 0 ? std::char_traits<char>::length(message) : static_cast<std::size_t>(length));
}

}  // namespace

Gl load_gl(const GetProcAddress& get_proc_address) {
  Gl gl;
  gl.GetString = lookup<PFNGLGETSTRINGPROC>(get_proc_address, "glGetString");
  gl.GetIntegerv = lookup<PFNGLGETINTEGERVPROC>(get_proc_address, "glGetIntegerv");
  const GLubyte* version = gl.GetString ? gl.GetString(GL_VERSION) : nullptr;
  if (version == nullptr || gl.GetIntegerv == nullptr)
    throw InputError("no OpenGL context could be made current");
  GLint major = 0, minor = 0;
  gl.GetIntegerv(GL_MAJOR_VERSION, &major);
  gl.GetIntegerv(GL_MINOR_VERSION, &minor);
  gl.version = 10 * major + minor;
  if (gl.version < kOldestVersion) {
    throw InputError(fmt::format("this display offers OpenGL {}, but 3.3 is needed",
                                 reinterpret_cast<const char*>(version)));
  }
#define STILLPOINT_GL_LOAD(TYPE, name)                               \
  gl.name = lookup<PFNGL##TYPE##PROC>(get_proc_address, "gl" #name); \
  if (gl.name == nullptr) throw InputError("the OpenGL driver lacks the function gl" #name);
  STILLPOINT_GL_FUNCTIONS(STILLPOINT_GL_LOAD)
#undef STILLPOINT_GL_LOAD
  gl.DebugMessageCallback = lookup<PFNGLDEBUGMESSAGECALLBACKPROC>(get_proc_address, "glDebugMessageCallback");
  gl.GetIntegerv(GL_MAX_SAMPLES, &gl.max_samples);
  gl.renderer = reinterpret_cast<const char*>(gl.GetString(GL_RENDERER));
  return gl;
}

GlErrorLog::GlErrorLog(const Gl& gl) : gl_(gl) {
  if (gl_.DebugMessageCallback == nullptr) return;
  gl_.Enable(GL_DEBUG_OUTPUT);
  gl_.Enable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
  gl_.DebugMessageCallback(collect_message, &messages_);
}

GlErrorLog::~GlErrorLog() {
  if (gl_.DebugMessageCallback != nullptr) gl_.DebugMessageCallback(nullptr, nullptr);
}

std::vector<std::string> GlErrorLog::take() {
  // A driver may offer the callback and yet stay silent outside debug contexts, so both ways are asked.
  for (GLenum error = gl_.GetError(); error != GL_NO_ERROR; error = gl_.GetError()) {
    messages_.push_back(fmt::format("GL error 0x{:04x}", error));
  }
  return std::exchange(messages_, {});
}

GlObject make_buffer(const Gl& gl) {
  GLuint id = 0;
  gl.GenBuffers(1, &id);
  return {gl, id, [](const Gl& g, GLuint name) { g.DeleteBuffers(1, &name); }};
}

GlObject make_vertex_array(const Gl& gl) {
  GLuint id = 0;
  gl.GenVertexArrays(1, &id);
  return {gl, id, [](const Gl& g, GLuint name) { g.DeleteVertexArrays(1, &name); }};
}

GlObject make_texture(const Gl& gl) {
  GLuint id = 0;
  gl.GenTextures(1, &id);
  return {gl, id, [](const Gl& g, GLuint name) { g.DeleteTextures(1, &name); }};
}

GlObject make_renderbuffer(const Gl& gl) {
  GLuint id = 0;
  gl.GenRenderbuffers(1, &id);
  return {gl, id, [](const Gl& g, GLuint name) { g.DeleteRenderbuffers(1, &name); }};
}

GlObject make_framebuffer(const Gl& gl) {
  GLuint id = 0;
  gl.GenFramebuffers(1, &id);
  return {gl, id, [](const Gl& g, GLuint name) { g.DeleteFramebuffers(1, &name); }};
}

}  // namespace stillpoint
