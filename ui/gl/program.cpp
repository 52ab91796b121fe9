#include "ui/gl/program.hpp"

#include <fmt/format.h>

#include <stdexcept>

#include "ui/gl/embedded_shaders.hpp"

namespace stillpoint {
namespace {

/// The first line a GL log has to say.
std::string first_line(const std::string& log) {
  const std::size_t begin = log.find_first_not_of(" \n\r\t");
  if (begin == std::string::npos) return "no reason given";
  return log.substr(begin, log.find_first_of("\r\n", begin) - begin);
}

GlObject compile(const Gl& gl, GLenum stage, const std::string& name, std::string_view source) {
  GlObject shader{gl, gl.CreateShader(stage), [](const Gl& g, GLuint id) { g.DeleteShader(id); }};
  const GLchar* text = source.data();
  const auto length = static_cast<GLint>(source.size());
  gl.ShaderSource(shader.id(), 1, &text, &length);
  gl.CompileShader(shader.id());
  GLint compiled = GL_FALSE;
  gl.GetShaderiv(shader.id(), GL_COMPILE_STATUS, &compiled);
  if (compiled == GL_TRUE) return shader;
  std::string log(4096, '\0');
  GLsizei written = 0;
  gl.GetShaderInfoLog(shader.id(), static_cast<GLsizei>(log.size()), &written, log.data());
  log.resize(static_cast<std::size_t>(written));
  throw std::runtime_error(fmt::format("shader {}.{} does not compile: {}", name,
                                       stage == GL_VERTEX_SHADER ? "vert" : "frag", first_line(log)));
}

}  // namespace

Program Program::embedded(const Gl& gl, std::string_view name) {
  const std::string base{name};
  return Program{gl, base, embedded_shader(base + ".vert"), embedded_shader(base + ".frag")};
}

Program::Program(const Gl& gl, std::string name, std::string_view vertex_source,
                 std::string_view fragment_source)
    : gl_(&gl), name_(std::move(name)) {
  const GlObject vertex = compile(gl, GL_VERTEX_SHADER, name_, vertex_source);
  const GlObject fragment = compile(gl, GL_FRAGMENT_SHADER, name_, fragment_source);
  program_ = GlObject{gl, gl.CreateProgram(), [](const Gl& g, GLuint id) { g.DeleteProgram(id); }};
  gl.AttachShader(program_.id(), vertex.id());
  gl.AttachShader(program_.id(), fragment.id());
  gl.LinkProgram(program_.id());
  GLint linked = GL_FALSE;
  gl.GetProgramiv(program_.id(), GL_LINK_STATUS, &linked);
  if (linked == GL_TRUE) return;
  std::string log(4096, '\0');
  GLsizei written = 0;
  gl.GetProgramInfoLog(program_.id(), static_cast<GLsizei>(log.size()), &written, log.data());
  log.resize(static_cast<std::size_t>(written));
  throw std::runtime_error(fmt::format("shader program {} does not link: {}", name_, first_line(log)));
}

void Program::use() const { gl_->UseProgram(program_.id()); }

GLint Program::location(const char* uniform) const {
  const auto known = locations_.find(uniform);
  if (known != locations_.end()) return known->second;
  const GLint found = gl_->GetUniformLocation(program_.id(), uniform);
  locations_.emplace(uniform, found);
  return found;
}

void Program::set(const char* uniform, int value) const { gl_->Uniform1i(location(uniform), value); }

void Program::set(const char* uniform, float value) const { gl_->Uniform1f(location(uniform), value); }

void Program::set(const char* uniform, const Eigen::Vector2f& value) const {
  gl_->Uniform2f(location(uniform), value.x(), value.y());
}

void Program::set(const char* uniform, const Eigen::Vector4f& value) const {
  gl_->Uniform4f(location(uniform), value.x(), value.y(), value.z(), value.w());
}

void Program::set(const char* uniform, const Eigen::Matrix4f& value) const {
  gl_->UniformMatrix4fv(location(uniform), 1, GL_FALSE, value.data());
}

}  // namespace stillpoint
