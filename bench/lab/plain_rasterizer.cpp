#include "lab/plain_rasterizer.h"

#include <glm/gtc/type_ptr.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec4.hpp>
#include <span>

#include "bench_support.h"
#include "gl/program.h"

namespace surfcast::lab {
namespace {

// Depth is near / z, which is larger in front. With floating point, its relative precision equals that of z.
constexpr const char* kVertex = R"(
layout(location = 0) in vec4 position_radius;
layout(location = 1) in vec3 surfel_normal;
layout(location = 2) in vec4 surfel_color;
layout(location = 0) uniform mat4 view;   // block to camera, z forward
layout(location = 1) uniform vec4 scale;  // 2 eta / width, 2 eta / height, eta, 1: only what faces the eye
flat out vec3 color;
flat out vec3 centre;
flat out vec3 normal;
flat out float radius;
void main() {
  vec3 o = (view * vec4(position_radius.xyz, 1.0)).xyz;
  color = surfel_color.rgb;
  centre = o;
  normal = mat3(view) * surfel_normal;
  radius = position_radius.w;
  bool away = scale.w > 0.0 && dot(normal, o) > 0.0;
#ifdef DISC
  gl_PointSize = max(2.0 * radius * scale.z / max(o.z - radius, 0.1 * o.z), 1.0) + 2.0;
#else
  gl_PointSize = max(2.0 * radius * scale.z / o.z, 1.0);
#endif
  gl_Position = away ? vec4(2.0, 2.0, 2.0, 1.0) : vec4(scale.xy * o.xy, NEAR, o.z);
}
)";
constexpr const char* kFragment = R"(
flat in vec3 color;
flat in vec3 centre;
flat in vec3 normal;
flat in float radius;
layout(location = 2) uniform vec3 screen;  // width / 2, height / 2, eta
layout(location = 0) out vec4 pixel;
void main() {
#ifdef DISC
  vec3 ray = vec3((gl_FragCoord.xy - screen.xy) / screen.z, 1.0);
  float z = dot(normal, centre) / dot(normal, ray);
  vec3 off = z * ray - centre;
  if (!(z > NEAR && dot(off, off) <= radius * radius)) discard;
  gl_FragDepth = NEAR / z;
#endif
  pixel = vec4(color, 1.0);
}
)";

/// Vertex buffer format, 32 bytes.
struct Vertex {
  glm::vec4 position_radius;  ///< relative to its block; world units
  glm::vec3 normal;
  glm::u8vec4 color;
};

glm::u8vec3 eight_bits(const glm::u16vec3& color, int bits) {
  return bits == 16 ? glm::u8vec3(glm::uvec3(color) / 257U) : glm::u8vec3(color);
}

std::vector<Vertex> vertices_of(const model::DecodedBlock& block, int color_bits) {
  const glm::dvec3 origin = block.grid.position(block.origin);
  constexpr glm::u8vec3 kGrey(231);  // 0.8 in linear light, the grey of splats without colours
  std::vector<Vertex> vertices;
  for (size_t i = 0; i < block.size(); ++i) {
    const glm::u8vec3 color = block.colors.empty() ? kGrey : eight_bits(block.colors[i], color_bits);
    vertices.push_back(
        {glm::vec4(block.position(i) - origin, block.radii[i]), block.normals[i], glm::u8vec4(color, 255)});
  }
  return vertices;
}

gl::Program make_program(const char* name, const std::string& defines) {
  return bench::value_or_exit(
      gl::make_program(name, {{GL_VERTEX_SHADER, "plain.vert", kVertex}, {GL_FRAGMENT_SHADER, "plain.frag", kFragment}},
                       defines + "#define NEAR 1e-4\n"));
}

void describe_vertices(const gl::VertexArray& vertices) {
  const auto attribute = [&](GLuint index, GLint size, GLenum type, GLboolean normalized, size_t offset) {
    glEnableVertexArrayAttrib(vertices.name(), index);
    glVertexArrayAttribFormat(vertices.name(), index, size, type, normalized, static_cast<GLuint>(offset));
    glVertexArrayAttribBinding(vertices.name(), index, 0);
  };
  attribute(0, 4, GL_FLOAT, GL_FALSE, offsetof(Vertex, position_radius));
  attribute(1, 3, GL_FLOAT, GL_FALSE, offsetof(Vertex, normal));
  attribute(2, 4, GL_UNSIGNED_BYTE, GL_TRUE, offsetof(Vertex, color));
}

/// Transformation from block coordinates to camera coordinates.
glm::mat4 view_of(const geometry::CameraFrame& frame, const glm::dvec3& origin) {
  return {glm::vec4(frame.right.x, frame.up.x, frame.forward.x, 0),
          glm::vec4(frame.right.y, frame.up.y, frame.forward.y, 0),
          glm::vec4(frame.right.z, frame.up.z, frame.forward.z, 0), glm::vec4(frame.to_camera(origin), 1)};
}

}  // namespace

PlainRasterizer::PlainRasterizer(const model::ModelFile& model, int width, int height)
    : width_(width),
      height_(height),
      oriented_(model.info().oriented),
      vertices_(gl::make_empty_vertex_array("plain")),
      color_(gl::make_texture_2d("plain color", GL_RGBA8, width, height)),
      depth_(gl::make_texture_2d("plain depth", GL_DEPTH_COMPONENT32F, width, height)),
      target_(gl::make_framebuffer("plain")),
      points_(make_program("plain points", "")),
      discs_(make_program("plain discs", "#define DISC\n")) {
  glNamedFramebufferTexture(target_.name(), GL_COLOR_ATTACHMENT0, color_.name(), 0);
  glNamedFramebufferTexture(target_.name(), GL_DEPTH_ATTACHMENT, depth_.name(), 0);
  describe_vertices(vertices_);
  for (uint32_t i = 0; i < model.blocks().size(); ++i) {
    if (model.tree().children(i).count == 0) add_block(model, i);
  }
}

void PlainRasterizer::add_block(const model::ModelFile& model, uint32_t index) {
  const model::DecodedBlock block = bench::value_or_exit(model.decode(index));
  const std::vector<Vertex> vertices = vertices_of(block, model.info().color_bits);
  blocks_.push_back({gl::make_buffer("plain", std::as_bytes(std::span(vertices))),
                     static_cast<GLsizei>(vertices.size()), block.grid.position(block.origin)});
}

void PlainRasterizer::draw(PlainShape shape, PlainFaces faces, const geometry::CameraFrame& frame,
                           std::vector<std::byte>& pixels) const {
  glBindFramebuffer(GL_FRAMEBUFFER, target_.name());
  glViewport(0, 0, width_, height_);
  glEnable(GL_PROGRAM_POINT_SIZE);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_GREATER);
  glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
  glDisable(GL_BLEND);
  constexpr float kBlack[4] = {0, 0, 0, 0};
  constexpr float kFar = 0;
  glClearBufferfv(GL_COLOR, 0, kBlack);
  glClearBufferfv(GL_DEPTH, 0, &kFar);
  glUseProgram(shape == PlainShape::kDisc ? discs_.name() : points_.name());
  glBindVertexArray(vertices_.name());
  const auto eta = static_cast<float>(frame.eta);
  const float half_width = 0.5F * static_cast<float>(width_);
  const float half_height = 0.5F * static_cast<float>(height_);
  glUniform4f(1, eta / half_width, eta / half_height, eta, oriented_ && faces == PlainFaces::kFront ? 1.0F : 0.0F);
  if (shape == PlainShape::kDisc) glUniform3f(2, half_width, half_height, eta);
  for (const Block& block : blocks_) {
    const glm::mat4 view = view_of(frame, block.origin);
    glUniformMatrix4fv(0, 1, GL_FALSE, glm::value_ptr(view));
    glVertexArrayVertexBuffer(vertices_.name(), 0, block.surfels.name(), 0, sizeof(Vertex));
    glDrawArrays(GL_POINTS, 0, block.count);
  }
  pixels.resize(static_cast<size_t>(width_) * static_cast<size_t>(height_) * 4);
  glReadPixels(0, 0, width_, height_, GL_RGBA, GL_UNSIGNED_BYTE, pixels.data());
}

}  // namespace surfcast::lab
