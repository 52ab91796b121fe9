#pragma once

#include <Eigen/Core>
#include <string>
#include <string_view>
#include <unordered_map>

#include "ui/gl/gl.hpp"

namespace stillpoint {

/// A linked vertex and fragment shader.
class Program {
 public:
  /// Builds from shaders/NAME.vert and shaders/NAME.frag as they were at build time.
  /// @throws std::runtime_error with the compiler's first complaint, in one sentence.
  static Program embedded(const Gl& gl, std::string_view name);

  /// Builds from source text; `name` is what errors call it.
  /// @throws std::runtime_error as embedded() does.
  Program(const Gl& gl, std::string name, std::string_view vertex_source, std::string_view fragment_source);

  void use() const;

  // Each sets a uniform of the program in use; a name the linker has optimised away is passed over.
  void set(const char* uniform, int value) const;
  void set(const char* uniform, float value) const;
  void set(const char* uniform, const Eigen::Vector2f& value) const;
  void set(const char* uniform, const Eigen::Vector4f& value) const;
  void set(const char* uniform, const Eigen::Matrix4f& value) const;

 private:
  [[nodiscard]] GLint location(const char* uniform) const;

  const Gl* gl_;
  std::string name_;
  GlObject program_;
  mutable std::unordered_map<std::string, GLint> locations_;
};

}  // namespace stillpoint
