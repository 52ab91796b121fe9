#pragma once

#include <GL/glcorearb.h>

#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace stillpoint {

// Every GL function the program calls, without its `gl` prefix. All belong to OpenGL 3.3 core.
#define STILLPOINT_GL_FUNCTIONS(X)                                  \
  X(ACTIVETEXTURE, ActiveTexture)                                   \
  X(ATTACHSHADER, AttachShader)                                     \
  X(BINDBUFFER, BindBuffer)                                         \
  X(BINDFRAMEBUFFER, BindFramebuffer)                               \
  X(BINDRENDERBUFFER, BindRenderbuffer)                             \
  X(BINDSAMPLER, BindSampler)                                       \
  X(BINDTEXTURE, BindTexture)                                       \
  X(BINDVERTEXARRAY, BindVertexArray)                               \
  X(BLENDEQUATION, BlendEquation)                                   \
  X(BLENDFUNCSEPARATE, BlendFuncSeparate)                           \
  X(BLITFRAMEBUFFER, BlitFramebuffer)                               \
  X(BUFFERDATA, BufferData)                                         \
  X(CHECKFRAMEBUFFERSTATUS, CheckFramebufferStatus)                 \
  X(CLEAR, Clear)                                                   \
  X(CLEARCOLOR, ClearColor)                                         \
  X(COLORMASK, ColorMask)                                           \
  X(COMPILESHADER, CompileShader)                                   \
  X(CREATEPROGRAM, CreateProgram)                                   \
  X(CREATESHADER, CreateShader)                                     \
  X(DELETEBUFFERS, DeleteBuffers)                                   \
  X(DELETEFRAMEBUFFERS, DeleteFramebuffers)                         \
  X(DELETEPROGRAM, DeleteProgram)                                   \
  X(DELETERENDERBUFFERS, DeleteRenderbuffers)                       \
  X(DELETESHADER, DeleteShader)                                     \
  X(DELETETEXTURES, DeleteTextures)                                 \
  X(DELETEVERTEXARRAYS, DeleteVertexArrays)                         \
  X(DEPTHFUNC, DepthFunc)                                           \
  X(DEPTHMASK, DepthMask)                                           \
  X(DISABLE, Disable)                                               \
  X(DRAWARRAYS, DrawArrays)                                         \
  X(DRAWELEMENTSBASEVERTEX, DrawElementsBaseVertex)                 \
  X(ENABLE, Enable)                                                 \
  X(ENABLEVERTEXATTRIBARRAY, EnableVertexAttribArray)               \
  X(FINISH, Finish)                                                 \
  X(FRAMEBUFFERRENDERBUFFER, FramebufferRenderbuffer)               \
  X(FRAMEBUFFERTEXTURE2D, FramebufferTexture2D)                     \
  X(GENBUFFERS, GenBuffers)                                         \
  X(GENERATEMIPMAP, GenerateMipmap)                                 \
  X(GENFRAMEBUFFERS, GenFramebuffers)                               \
  X(GENRENDERBUFFERS, GenRenderbuffers)                             \
  X(GENTEXTURES, GenTextures)                                       \
  X(GENVERTEXARRAYS, GenVertexArrays)                               \
  X(GETERROR, GetError)                                             \
  X(GETINTEGERV, GetIntegerv)                                       \
  X(GETPROGRAMINFOLOG, GetProgramInfoLog)                           \
  X(GETPROGRAMIV, GetProgramiv)                                     \
  X(GETSHADERINFOLOG, GetShaderInfoLog)                             \
  X(GETSHADERIV, GetShaderiv)                                       \
  X(GETSTRING, GetString)                                           \
  X(GETUNIFORMLOCATION, GetUniformLocation)                         \
  X(ISENABLED, IsEnabled)                                           \
  X(LINKPROGRAM, LinkProgram)                                       \
  X(PIXELSTOREI, PixelStorei)                                       \
  X(POLYGONMODE, PolygonMode)                                       \
  X(READBUFFER, ReadBuffer)                                         \
  X(READPIXELS, ReadPixels)                                         \
  X(RENDERBUFFERSTORAGEMULTISAMPLE, RenderbufferStorageMultisample) \
  X(SCISSOR, Scissor)                                               \
  X(SHADERSOURCE, ShaderSource)                                     \
  X(TEXIMAGE2D, TexImage2D)                                         \
  X(TEXPARAMETERI, TexParameteri)                                   \
  X(TEXPARAMETERIV, TexParameteriv)                                 \
  X(TEXSUBIMAGE2D, TexSubImage2D)                                   \
  X(UNIFORM1F, Uniform1f)                                           \
  X(UNIFORM1I, Uniform1i)                                           \
  X(UNIFORM2F, Uniform2f)                                           \
  X(UNIFORM4F, Uniform4f)                                           \
  X(UNIFORMMATRIX4FV, UniformMatrix4fv)                             \
  X(USEPROGRAM, UseProgram)                                         \
  X(VERTEXATTRIBPOINTER, VertexAttribPointer)                       \
  X(VIEWPORT, Viewport)

/// Resolves the name of a GL function in one context; null when that context has none of that name.
using GetProcAddress = std::function<void*(const char* name)>;

/// The GL functions of one context, loaded through the shell that made it.
///
/// Each context has a table of its own: an OSMesa context and a window's context live in one process and do
/// not share entry points. Calls are valid while that context is current.
struct Gl {
#define STILLPOINT_GL_MEMBER(TYPE, name) PFNGL##TYPE##PROC name = nullptr;
  STILLPOINT_GL_FUNCTIONS(STILLPOINT_GL_MEMBER)
#undef STILLPOINT_GL_MEMBER
  PFNGLDEBUGMESSAGECALLBACKPROC DebugMessageCallback = nullptr;  ///< KHR_debug; null where it is missing
  int version = 0;                                               ///< 10 * major + minor
  int max_samples = 0;                                           ///< samples a pixel a framebuffer may have
  std::string renderer;  ///< what draws, such as "llvmpipe (LLVM 15.0.6, 256 bits)"
};

/// Loads the table of the current context.
/// @throws InputError when the context is older than OpenGL 3.3 or lacks a function.
[[nodiscard]] Gl load_gl(const GetProcAddress& get_proc_address);

/// Collects what GL complains about from construction on, in the context current then.
///
/// By KHR_debug where there is one, each complaint a sentence; else by glGetError, which take() polls.
class GlErrorLog {
 public:
  explicit GlErrorLog(const Gl& gl);
  ~GlErrorLog();
  GlErrorLog(const GlErrorLog&) = delete;
  GlErrorLog& operator=(const GlErrorLog&) = delete;

  /// The complaints since the last call, oldest first.
  [[nodiscard]] std::vector<std::string> take();

 private:
  const Gl& gl_;
  std::vector<std::string> messages_;
};

/// Owns one GL object. The context it was made in must be current when it goes.
class GlObject {
 public:
  using Destroy = void (*)(const Gl& gl, GLuint id);

  GlObject() = default;
  GlObject(const Gl& gl, GLuint id, Destroy destroy) : gl_(&gl), id_(id), destroy_(destroy) {}
  GlObject(GlObject&& other) noexcept { swap(other); }
  GlObject& operator=(GlObject&& other) noexcept {
    swap(other);
    return *this;
  }
  ~GlObject() {
    if (id_ != 0) destroy_(*gl_, id_);
  }

  [[nodiscard]] GLuint id() const { return id_; }

 private:
  void swap(GlObject& other) {
    std::swap(gl_, other.gl_);
    std::swap(id_, other.id_);
    std::swap(destroy_, other.destroy_);
  }

  const Gl* gl_ = nullptr;
  GLuint id_ = 0;
  Destroy destroy_ = nullptr;
};

[[nodiscard]] GlObject make_buffer(const Gl& gl);
[[nodiscard]] GlObject make_vertex_array(const Gl& gl);
[[nodiscard]] GlObject make_texture(const Gl& gl);
[[nodiscard]] GlObject make_renderbuffer(const Gl& gl);
[[nodiscard]] GlObject make_framebuffer(const Gl& gl);

}  // namespace stillpoint
