#include "gl_points.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <glm/gtc/type_ptr.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec4.hpp>
#include <span>

#include "gl/program.h"

namespace surfcast::bench {
namespace {

constexpr const char* kVertex = R"(
layout(location = 0) in vec3 position;
layout(location = 1) in vec4 vertex_color;
layout(location = 0) uniform mat4 view;       // block to camera, z forward
layout(location = 1) uniform vec4 projection;  // 2 eta / width, 2 eta / height, near, point diameter times eta
out vec3 color;
void main() {
  vec3 o = (view * vec4(position, 1.0)).xyz;
  color = vertex_color.rgb;
  gl_PointSize = max(projection.w / o.z, 1.0);
  gl_Position = vec4(projection.xy * o.xy, o.z - 2.0 * projection.z, o.z);
}
)";
constexpr const char* kFragment = R"(
in vec3 color;
layout(location = 0) out vec4 pixel;
void main() { pixel = vec4(color, 1.0); }
)";

/// 16 bytes: a point and its colour.
struct Vertex {
  glm::vec3 position;  ///< relative to its block
  glm::u8vec4 color;
};

std::vector<Vertex> vertices_of(const DecodedBlock& block) {
  const glm::dvec3 origin = block.grid.position(block.origin);
  std::vector<Vertex> vertices;
  for (size_t i = 0; i < block.size(); ++i) {
    vertices.push_back({glm::vec3(block.position(i) - origin), glm::u8vec4(block.colors[i], 255)});
  }
  return vertices;
}

}  // namespace

GlPoints::GlPoints(const ModelFile& model, int width, int height)
    : width_(width),
      height_(height),
      vertices_(gl::make_empty_vertex_array("points")),
      color_(gl::make_texture_2d("points color", GL_RGBA8, width, height)),
      depth_(gl::make_texture_2d("points depth", GL_DEPTH_COMPONENT32F, width, height)),
      target_(gl::make_framebuffer("points")) {
  Result<gl::Program> program = gl::make_program(
      "points", {{GL_VERTEX_SHADER, "points.vert", kVertex}, {GL_FRAGMENT_SHADER, "points.frag", kFragment}});
  if (!program) {
    std::fprintf(stderr, "%s\n", program.error().message.c_str());
    std::exit(1);
  }
  program_ = std::move(*program);
  glNamedFramebufferTexture(target_.name(), GL_COLOR_ATTACHMENT0, color_.name(), 0);
  glNamedFramebufferTexture(target_.name(), GL_DEPTH_ATTACHMENT, depth_.name(), 0);
  glEnableVertexArrayAttrib(vertices_.name(), 0);
  glVertexArrayAttribFormat(vertices_.name(), 0, 3, GL_FLOAT, GL_FALSE, 0);
  glVertexArrayAttribBinding(vertices_.name(), 0, 0);
  glEnableVertexArrayAttrib(vertices_.name(), 1);
  glVertexArrayAttribFormat(vertices_.name(), 1, 4, GL_UNSIGNED_BYTE, GL_TRUE, 12);
  glVertexArrayAttribBinding(vertices_.name(), 1, 0);
  for (uint32_t i = 0; i < model.blocks().size(); ++i) {
    if (model.tree().children(i).count == 0) add_block(model, i);
  }
}

void GlPoints::add_block(const ModelFile& model, uint32_t index) {
  const Result<DecodedBlock> block = model.decode(index);
  if (!block) {
    std::fprintf(stderr, "%s\n", block.error().message.c_str());
    std::exit(1);
  }
  const std::vector<Vertex> vertices = vertices_of(*block);
  blocks_.push_back({gl::make_buffer("points", std::as_bytes(std::span(vertices))),
                     static_cast<GLsizei>(vertices.size()), block->grid.position(block->origin),
                     *std::max_element(block->radii.begin(), block->radii.end())});
}

void GlPoints::draw(const CameraFrame& frame, std::vector<std::byte>& pixels) const {
  glBindFramebuffer(GL_FRAMEBUFFER, target_.name());
  glViewport(0, 0, width_, height_);
  glEnable(GL_PROGRAM_POINT_SIZE);
  glEnable(GL_DEPTH_TEST);
  glDisable(GL_BLEND);
  constexpr float kBlack[4] = {0, 0, 0, 0};
  constexpr float kFar = 1;
  glClearBufferfv(GL_COLOR, 0, kBlack);
  glClearBufferfv(GL_DEPTH, 0, &kFar);
  glUseProgram(program_.name());
  glBindVertexArray(vertices_.name());
  for (const Block& block : blocks_) {
    glVertexArrayVertexBuffer(vertices_.name(), 0, block.points.name(), 0, sizeof(Vertex));
    const glm::dvec3 o = frame.to_camera(block.origin);
    const glm::mat4 view(glm::vec4(frame.right.x, frame.up.x, frame.forward.x, 0),
                         glm::vec4(frame.right.y, frame.up.y, frame.forward.y, 0),
                         glm::vec4(frame.right.z, frame.up.z, frame.forward.z, 0), glm::vec4(o, 1));
    glUniformMatrix4fv(0, 1, GL_FALSE, glm::value_ptr(view));
    glUniform4f(1, static_cast<float>(2 * frame.eta / width_), static_cast<float>(2 * frame.eta / height_), 0.01F,
                static_cast<float>(2 * block.radius * frame.eta));
    glDrawArrays(GL_POINTS, 0, block.count);
  }
  pixels.resize(static_cast<size_t>(width_) * static_cast<size_t>(height_) * 4);
  glReadPixels(0, 0, width_, height_, GL_RGBA, GL_UNSIGNED_BYTE, pixels.data());
}

}  // namespace surfcast::bench
