// Draws a textured mesh by rays, in double precision, and compares a picture with it: mesh_study MESH WIDTH,HEIGHT
// px,py,pz fx,fy,fz ux,uy,uz ANGLE OUT.ppm [PICTURE.png]. 8 x 8 rays a pixel, the bilinear texture in linear light, the
// pixel prefilter of kernel.md.
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <string>

#include "geometry/camera.h"
#include "lab/mesh_caster.h"
#include "mesh/mesh_reader.h"
#include "mesh/texture.h"

namespace surfcast {
namespace {

glm::dvec3 vector_of(const char* text) {
  glm::dvec3 v(0);
  std::sscanf(text, "%lf,%lf,%lf", &v.x, &v.y, &v.z);
  return v;
}

reference::SrgbPicture colors_of(const mesh::Texture& picture) {
  reference::SrgbPicture colors{static_cast<int>(picture.width), static_cast<int>(picture.height), {}};
  for (const auto& texel : picture.texels) colors.pixels.emplace_back(texel[0], texel[1], texel[2]);
  return colors;
}

int study(int argc, char** argv) {
  if (argc < 8) {
    std::fputs("usage: mesh_study MESH WIDTH,HEIGHT POSITION FOCAL_POINT VIEW_UP ANGLE OUT.ppm [PICTURE]\n", stderr);
    return 2;
  }
  const std::optional<mesh::MeshFormat> format = mesh::mesh_format_of(argv[1], mesh::FacePolicy::kUse);
  if (!format) return 1;
  const Result<mesh::Mesh> mesh = mesh::read_mesh(argv[1], *format, {});
  if (!mesh) {
    std::fprintf(stderr, "%s\n", mesh.error().message.c_str());
    return 1;
  }
  int width = 0;
  int height = 0;
  std::sscanf(argv[2], "%d,%d", &width, &height);
  const geometry::Camera camera{vector_of(argv[3]), vector_of(argv[4]), vector_of(argv[5]), std::atof(argv[6])};
  const Result<geometry::CameraFrame> frame = make_camera_frame(camera, width, height);
  if (!frame) return 1;
  const reference::LightPicture ideal = lab::MeshCaster(*mesh).picture(*frame);
  if (!reference::write_ppm(argv[7], encode(ideal))) return 1;
  if (argc < 9) return 0;
  const Result<mesh::Texture> picture = mesh::read_texture({argv[8], argv[8], {}, {}}, {});
  if (!picture || picture->width != width || picture->height != height) {
    std::fprintf(stderr, "%s: no picture of that size\n", argv[8]);
    return 1;
  }
  const lab::MeshError error = lab::error_of(ideal, colors_of(*picture));
  std::printf("%.2f dB, %.2f dB inside\n", error.whole, error.inside);
  return 0;
}

}  // namespace
}  // namespace surfcast

int main(int argc, char** argv) {
  return surfcast::study(argc, argv);
}
