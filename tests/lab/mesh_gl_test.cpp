#include "builder/build_model.h"
#include "lab/mesh_caster.h"
#include "lab/mesh_scenes.h"
#include "lab/srgb_pictures.h"
#include "mesh/mesh_reader.h"
#include "render/gl_fixture.h"

namespace surfcast::lab {
namespace {

constexpr int kSide = 256;  // pixels

/// A view of the textured cube from a place that no constant was chosen by. `whole` and `inside` are required, dB.
struct View {
  const char* name;
  glm::dvec3 eye;
  double whole;
  double inside;
};

class TexturedCubeGLTest : public testing::RendererFixture, public ::testing::WithParamInterface<View> {
 protected:
  MeshError measure(const View& view) {
    const std::filesystem::path file = *write_mesh_scene("cube", folder_);
    const std::filesystem::path target = folder_ / "cube.surf";
    EXPECT_TRUE(builder::build_model(std::array{file}, target, {}, [](const builder::BuildStep&) {}));
    model_ = std::make_shared<const model::ModelFile>(std::move(*model::ModelFile::open(target)));

    picture::PictureRequest request;
    request.camera = geometry::Camera{view.eye, {0, 0, 0}, {0, 0, 1}, 30};
    request.width = request.height = kSide;
    request.silhouettes = true;
    const reference::SrgbPicture drawn = picture_of(draw(model_, request).image);

    const Result<mesh::Mesh> mesh = mesh::read_mesh(file, mesh::MeshFormat::kObj, {});
    const auto frame = geometry::make_camera_frame(*request.camera, kSide, kSide);
    return error_of(MeshCaster(*mesh).picture(*frame), drawn);
  }
};

TEST_P(TexturedCubeGLTest, ComesNearTheRaysAlsoWhereFacesMeet) {
  const MeshError error = measure(GetParam());
  std::printf("[ measured ] %.2f dB, inside %.2f dB\n", error.whole, error.inside);
  EXPECT_GE(error.whole, GetParam().whole);
  EXPECT_GE(error.inside, GetParam().inside);
}

INSTANTIATE_TEST_SUITE_P(Views, TexturedCubeGLTest,
                         ::testing::Values(View{"middle", {3, 2, 7.2}, 44.5, 46}, View{"far", {-15, 7, 8.4}, 50.5, 46}),
                         [](const auto& view) { return std::string(view.param.name); });

}  // namespace
}  // namespace surfcast::lab
