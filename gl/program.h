#pragma once
#include <epoxy/gl.h>

#include <string>
#include <vector>

#include "core/geometry.h"

namespace strandcast::gl {

/// One shader of a program. `text` starts with #version; `defines` ("#define A 1\n...") are inserted after
/// that line.
struct ShaderStage {
  GLenum kind;  ///< GL_COMPUTE_SHADER, GL_VERTEX_SHADER, ...
  const char* text;
  std::string defines = {};
};

/// A linked program. Needs a current context for its whole life. Setting a uniform that the program does not
/// have has no effect.
class Program {
 public:
  /// `name` appears in errors. Throws Error with the driver's log if it does not build.
  Program(const std::string& name, const std::vector<ShaderStage>& stages);
  ~Program();
  Program(Program&& other) noexcept : id_(other.id_) { other.id_ = 0; }
  Program& operator=(Program&& other) noexcept {
    std::swap(id_, other.id_);
    return *this;
  }

  void use() const { glUseProgram(id_); }
  GLuint id() const { return id_; }
  void set(const char* name, int value) const { glProgramUniform1i(id_, location(name), value); }
  void set(const char* name, unsigned value) const { glProgramUniform1ui(id_, location(name), value); }
  void set(const char* name, float value) const { glProgramUniform1f(id_, location(name), value); }
  void set(const char* name, const Eigen::Vector2f& v) const {
    glProgramUniform2fv(id_, location(name), 1, v.data());
  }
  void set(const char* name, const Vec3& v) const { glProgramUniform3fv(id_, location(name), 1, v.data()); }
  void set(const char* name, const Eigen::Matrix4f& m) const {
    glProgramUniformMatrix4fv(id_, location(name), 1, GL_FALSE, m.data());
  }

 private:
  GLint location(const char* name) const { return glGetUniformLocation(id_, name); }
  GLuint id_ = 0;
};

}  // namespace strandcast::gl
