#include "numerics/shader_bench.h"

#include <gtest/gtest.h>

#include "gl/program.h"
#include "render/shader_library.h"

namespace surfcast::testing {
namespace {

void append(const char* file, std::string& text) {
  const Result<std::string> part = render::shader_text(file);
  if (!part) throw std::runtime_error(part.error().message);
  text += *part;
}

std::string library(std::span<const char* const> files) {
  std::string text;
  for (const char* file : {"shared/kernel.h", "shared/frame_layout.h", "include/frame.glsl", "include/packing.glsl",
                           "include/resampling_filter.glsl", "include/splat_record.glsl", "include/fixed_sum.glsl"}) {
    append(file, text);
  }
  for (const char* file : files) append(file, text);
  return text;
}

std::string source_of(const std::string& body, int ins, int outs, std::span<const char* const> files) {
  const std::string m = std::to_string(ins);
  const std::string n = std::to_string(outs);
  return library(files) +
         "layout(local_size_x = 64) in;\n"
         "layout(std430, binding = 0) readonly buffer Inputs { vec4 inputs[]; };\n"
         "layout(std430, binding = 1) writeonly buffer Outputs { vec4 outputs[]; };\n"
         "void main() {\n"
         "  uint i = gl_GlobalInvocationID.x;\n"
         "  if (i >= uint(outputs.length()) / " +
         n +
         "u) return;\n"
         "  vec4 in_[" +
         m + "]; vec4 out_[" + n +
         "];\n"
         "  for (uint k = 0u; k < " +
         m + "u; ++k) in_[k] = inputs[i * " + m + "u + k];\n" + body + "  for (uint k = 0u; k < " + n +
         "u; ++k) outputs[i * " + n +
         "u + k] = out_[k];\n"
         "}\n";
}

}  // namespace

ShaderBench::ShaderBench() {
  Result<std::unique_ptr<gl::EglContext>> context = gl::EglContext::create(-1);
  if (!context) throw std::runtime_error(context.error().message);
  context_ = std::move(*context);
}

std::vector<glm::vec4> ShaderBench::run(const std::string& body, const layout::FrameConstants& frame, int ins, int outs,
                                        std::span<const glm::vec4> inputs, std::span<const char* const> files) {
  const Result<gl::Program> program =
      gl::make_program("bench", {{GL_COMPUTE_SHADER, "bench", source_of(body, ins, outs, files)}},
                       "#define SURFCAST_COLUMNS 1\n#define SURFCAST_ROWS 1\n");
  if (!program) {
    ADD_FAILURE() << program.error().message;
    return {};
  }
  const size_t cases = inputs.size() / static_cast<size_t>(ins);
  std::vector<glm::vec4> outputs(cases * static_cast<size_t>(outs));
  const gl::Buffer constants = gl::make_buffer("frame", std::as_bytes(std::span(&frame, 1)));
  const gl::Buffer from = gl::make_buffer("inputs", std::as_bytes(inputs));
  const gl::Buffer to = gl::make_buffer("outputs", outputs.size() * sizeof(glm::vec4));
  glBindBufferBase(GL_UNIFORM_BUFFER, SURFCAST_BIND_FRAME, constants.name());
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, from.name());
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 1, to.name());
  glUseProgram(program->name());
  glDispatchCompute(static_cast<GLuint>((cases + 63) / 64), 1, 1);
  glMemoryBarrier(GL_ALL_BARRIER_BITS);
  glGetNamedBufferSubData(to.name(), 0, static_cast<GLsizeiptr>(outputs.size() * sizeof(glm::vec4)), outputs.data());
  EXPECT_EQ(glGetError(), static_cast<GLenum>(GL_NO_ERROR));
  return outputs;
}

layout::FrameConstants frame_of(float eta, float width, float height) {
  layout::FrameConstants frame{};
  frame.right.w = eta;
  frame.up.w = 0.5F * width;
  frame.forward.w = 0.5F * height;
  return frame;
}

}  // namespace surfcast::testing
