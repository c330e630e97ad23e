#include "gl/program.h"

namespace surfcast::gl {
namespace {

template <typename GetLength, typename GetLog>
std::string info_log(GLuint name, GetLength get_length, GetLog get_log) {
  GLint length = 0;
  get_length(name, GL_INFO_LOG_LENGTH, &length);
  std::string log(static_cast<size_t>(length), '\0');
  if (length > 0) get_log(name, length, nullptr, log.data());
  return log;
}

Result<GLuint> compile(const StageSource& stage, const std::string& defines) {
  const std::string text = "#version 450 core\n" + defines + std::string(stage.source);
  const char* pointer = text.c_str();
  const GLuint shader = glCreateShader(stage.stage);
  glShaderSource(shader, 1, &pointer, nullptr);
  glCompileShader(shader);
  GLint ok = GL_FALSE;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &ok);
  if (ok == GL_TRUE) return shader;
  const std::string log = info_log(shader, glGetShaderiv, glGetShaderInfoLog);
  glDeleteShader(shader);
  return fail(ErrorKind::kInternal, "shader " + std::string(stage.name) + " does not compile: " + log);
}

}  // namespace

Result<Program> make_program(const char* label, std::initializer_list<StageSource> stages, const std::string& defines) {
  Program program(glCreateProgram());
  for (const StageSource& stage : stages) {
    Result<GLuint> shader = compile(stage, defines);
    if (!shader) return fail(shader);
    glAttachShader(program.name(), *shader);
    glDeleteShader(*shader);  // deleted when it is detached
  }
  glLinkProgram(program.name());
  glObjectLabel(GL_PROGRAM, program.name(), -1, label);
  GLint ok = GL_FALSE;
  glGetProgramiv(program.name(), GL_LINK_STATUS, &ok);
  if (ok == GL_TRUE) return program;
  return fail(ErrorKind::kInternal,
              std::string(label) + " does not link: " + info_log(program.name(), glGetProgramiv, glGetProgramInfoLog));
}

}  // namespace surfcast::gl
