#include "gl/program.h"

#include "core/error.h"

namespace strandcast::gl {
namespace {

std::string withDefines(const ShaderStage& stage) {
  std::string text = stage.text;
  const size_t version = text.find("#version");
  const size_t line_end = text.find('\n', version == std::string::npos ? 0 : version);
  return text.insert(line_end + 1, stage.defines);
}

GLuint compile(const std::string& name, const ShaderStage& stage) {
  const GLuint shader = glCreateShader(stage.kind);
  const std::string text = withDefines(stage);
  const char* source = text.c_str();
  glShaderSource(shader, 1, &source, nullptr);
  glCompileShader(shader);
  GLint ok = GL_FALSE;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &ok);
  if (ok == GL_TRUE) return shader;
  std::string log(4096, '\0');
  GLsizei length = 0;
  glGetShaderInfoLog(shader, static_cast<GLsizei>(log.size()), &length, log.data());
  glDeleteShader(shader);
  throw Error("a shader does not compile", name + ": " + log.substr(0, length),
              "the GL driver may be too old");
}

}  // namespace

Program::Program(const std::string& name, const std::vector<ShaderStage>& stages) : id_(glCreateProgram()) {
  std::vector<GLuint> shaders;
  auto discard = [&] {
    for (GLuint shader : shaders) glDeleteShader(shader);
  };
  try {
    for (const ShaderStage& stage : stages) {
      shaders.push_back(compile(name, stage));
      glAttachShader(id_, shaders.back());
    }
  } catch (...) {
    discard();
    glDeleteProgram(id_);
    throw;
  }
  glLinkProgram(id_);
  discard();
  GLint ok = GL_FALSE;
  glGetProgramiv(id_, GL_LINK_STATUS, &ok);
  if (ok == GL_TRUE) return;
  std::string log(4096, '\0');
  GLsizei length = 0;
  glGetProgramInfoLog(id_, static_cast<GLsizei>(log.size()), &length, log.data());
  glDeleteProgram(id_);
  throw Error("a shader program does not link", name + ": " + log.substr(0, length),
              "the GL driver may be too old");
}

Program::~Program() {
  if (id_ != 0) glDeleteProgram(id_);
}

}  // namespace strandcast::gl
