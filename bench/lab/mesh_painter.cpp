#include "lab/mesh_painter.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <glm/gtc/type_ptr.hpp>
#include <glm/mat4x4.hpp>
#include <span>

#include "bench_support.h"
#include "gl/program.h"
#include "mesh/placed_triangle.h"
#include "mesh/texture.h"

namespace surfcast::lab {
namespace {

// Depth is near / z, which is larger in front.
constexpr const char* kVertex = R"(
layout(location = 0) in vec3 position;
layout(location = 1) in vec2 corner_uv;
layout(location = 0) uniform mat4 view;   // world to camera, z forward
layout(location = 1) uniform vec2 scale;
out vec2 uv;
void main() {
  vec3 o = (view * vec4(position, 1.0)).xyz;
  uv = corner_uv;
  gl_Position = vec4(scale * o.xy, 1e-4, o.z);
}
)";
constexpr const char* kFragment = R"(
layout(binding = 0) uniform sampler2D image;
in vec2 uv;
layout(location = 0) out vec4 pixel;
void main() { pixel = vec4(texture(image, uv).rgb, 1.0); }
)";

/// Vertex buffer format, 20 bytes.
struct CornerVertex {
  glm::vec3 position;
  glm::vec2 uv;
};

std::vector<CornerVertex> corners_of(const mesh::Patch& patch) {
  std::vector<CornerVertex> corners;
  for (const mesh::Triangle& triangle : *patch.triangles) {
    const mesh::PlacedTriangle placed = place(patch, triangle, false);
    if (!placed.uvs) continue;
    for (size_t k = 0; k < 3; ++k) corners.push_back({glm::vec3(placed.positions[k]), glm::vec2((*placed.uvs)[k])});
  }
  return corners;
}

GLint wrap_mode(mesh::Wrap wrap) {
  if (wrap == mesh::Wrap::kClamp) return GL_CLAMP_TO_EDGE;
  return wrap == mesh::Wrap::kMirror ? GL_MIRRORED_REPEAT : GL_REPEAT;
}

gl::Texture mip_map(const mesh::Texture& image, const std::array<mesh::Wrap, 2>& wrap, int probes) {
  std::vector<glm::vec4> light;
  light.reserve(image.texels.size());
  for (const auto& texel : image.texels) {
    light.emplace_back(reference::linear_from_srgb8({texel[0], texel[1], texel[2]}), 1);
  }
  const glm::ivec2 size = image.size();
  GLuint name = 0;
  glCreateTextures(GL_TEXTURE_2D, 1, &name);
  glTextureStorage2D(name, 1 + static_cast<int>(std::log2(std::max(size.x, size.y))), GL_RGBA32F, size.x, size.y);
  glTextureSubImage2D(name, 0, 0, 0, size.x, size.y, GL_RGBA, GL_FLOAT, light.data());
  glGenerateTextureMipmap(name);
  glTextureParameteri(name, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
  glTextureParameteri(name, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  glTextureParameteri(name, GL_TEXTURE_MAX_ANISOTROPY_EXT, probes);
  glTextureParameteri(name, GL_TEXTURE_WRAP_S, wrap_mode(wrap[0]));
  glTextureParameteri(name, GL_TEXTURE_WRAP_T, wrap_mode(wrap[1]));
  return gl::Texture(name);
}

glm::mat4 view_matrix(const geometry::CameraFrame& frame) {
  return {glm::vec4(frame.right.x, frame.up.x, frame.forward.x, 0),
          glm::vec4(frame.right.y, frame.up.y, frame.forward.y, 0),
          glm::vec4(frame.right.z, frame.up.z, frame.forward.z, 0), glm::vec4(frame.to_camera(glm::dvec3(0)), 1)};
}

/// The texture that was drawn, whose rows run from bottom to top.
reference::LightPicture read_light(const gl::Texture& color, int width, int height) {
  std::vector<glm::vec4> pixels(static_cast<size_t>(width) * static_cast<size_t>(height));
  glGetTextureImage(color.name(), 0, GL_RGBA, GL_FLOAT, static_cast<GLsizei>(pixels.size() * sizeof(glm::vec4)),
                    pixels.data());
  reference::LightPicture picture(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      picture.pixels[picture.index(x, y)] = glm::dvec4(pixels[picture.index(x, height - 1 - y)]);
    }
  }
  return picture;
}

}  // namespace

MeshPainter::MeshPainter(const mesh::Mesh& mesh)
    : program_(bench::value_or_exit(gl::make_program(
          "mesh", {{GL_VERTEX_SHADER, "mesh.vert", kVertex}, {GL_FRAGMENT_SHADER, "mesh.frag", kFragment}}))),
      vertices_(gl::make_empty_vertex_array("mesh")) {
  glGetIntegerv(GL_MAX_TEXTURE_MAX_ANISOTROPY_EXT, &probes_);
  const auto attribute = [&](GLuint index, GLint size, size_t offset) {
    glEnableVertexArrayAttrib(vertices_.name(), index);
    glVertexArrayAttribFormat(vertices_.name(), index, size, GL_FLOAT, GL_FALSE, static_cast<GLuint>(offset));
    glVertexArrayAttribBinding(vertices_.name(), index, 0);
  };
  attribute(0, 3, offsetof(CornerVertex, position));
  attribute(1, 2, offsetof(CornerVertex, uv));
  for (const mesh::Patch& patch : mesh.patches) {
    if (mesh.materials[patch.material].image) add(mesh, patch);
  }
}

void MeshPainter::add(const mesh::Mesh& mesh, const mesh::Patch& patch) {
  const mesh::Material& material = mesh.materials[patch.material];
  const mesh::Texture image = bench::value_or_exit(mesh::read_texture(mesh.images[*material.image], {}));
  const std::vector<CornerVertex> corners = corners_of(patch);
  parts_.push_back({gl::make_buffer("mesh", std::as_bytes(std::span(corners))), static_cast<GLsizei>(corners.size()),
                    mip_map(image, material.wrap, probes_)});
}

reference::LightPicture MeshPainter::draw(const geometry::CameraFrame& frame, int samples) const {
  const glm::ivec2 pixels = glm::ivec2(frame.width, frame.height) + 2 * reference::kFilterReach;
  const glm::ivec2 size = samples * pixels;
  const gl::Texture color = gl::make_texture_2d("mesh color", GL_RGBA32F, size.x, size.y);
  const gl::Texture depth = gl::make_texture_2d("mesh depth", GL_DEPTH_COMPONENT32F, size.x, size.y);
  const gl::Framebuffer target = gl::make_framebuffer("mesh");
  glNamedFramebufferTexture(target.name(), GL_COLOR_ATTACHMENT0, color.name(), 0);
  glNamedFramebufferTexture(target.name(), GL_DEPTH_ATTACHMENT, depth.name(), 0);
  glBindFramebuffer(GL_FRAMEBUFFER, target.name());
  glViewport(0, 0, size.x, size.y);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_GREATER);
  glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
  constexpr float kBlack[4] = {0, 0, 0, 0};
  constexpr float kFar = 0;
  glClearBufferfv(GL_COLOR, 0, kBlack);
  glClearBufferfv(GL_DEPTH, 0, &kFar);
  glUseProgram(program_.name());
  glBindVertexArray(vertices_.name());
  const glm::mat4 view = view_matrix(frame);
  const glm::vec2 scale = 2 * static_cast<float>(frame.eta) / glm::vec2(pixels);
  glUniformMatrix4fv(0, 1, GL_FALSE, glm::value_ptr(view));
  glUniform2f(1, scale.x, scale.y);
  for (const Part& part : parts_) {
    glBindTextureUnit(0, part.texture.name());
    glVertexArrayVertexBuffer(vertices_.name(), 0, part.corners.name(), 0, sizeof(CornerVertex));
    glDrawArrays(GL_TRIANGLES, 0, part.count);
  }
  return read_light(color, size.x, size.y);
}

}  // namespace surfcast::lab
