// gaussian_study FOLDER FILE...: how exactly the pictures of Gaussian models are drawn. FILE is a model in any format
// that is read, or the name of a generated one (ball, fog, needles, near). Prints a Markdown table: the PSNR of our
// pictures against the rules of the training program and against exact footprints, both in double precision, and of
// both against 3 x 3 exact rays a pixel. Models are built in FOLDER.

#include <cstring>
#include <string>

#include "bench_support.h"
#include "gaussian/gaussian_reader.h"
#include "gaussian/gaussian_scenes.h"
#include "model/fit_model.h"
#include "reference/gaussian_renderer.h"

namespace surfcast::bench {
namespace {

using reference::LightPicture;

constexpr int kSide = 128;  // pixels
constexpr int kRays = 3;    // of a pixel along each axis

struct View {
  const char* name;
  double distance;  ///< of the eye from the focal point, relative to the view that fits the model
  double angle;     ///< degrees
};
constexpr View kViews[] = {{"whole", 1, 30}, {"close, wide", 0.3, 95}, {"far", 12, 30}};

struct Subject {
  std::string name;
  reference::GaussianModel model;
  testing::ModelPointer built;
  reference::GaussianConvention convention = reference::GaussianConvention::kTrained;
};

Subject subject_of(const std::string& argument, const std::filesystem::path& folder) {
  const bool generated = !std::filesystem::exists(argument);
  std::filesystem::path input = argument;
  if (generated) input = testing::write_ply(folder / "model.ply", reference::make_gaussian_model(argument));
  Subject subject{input.stem().string(), testing::reference_model(input), nullptr};
  if (generated) subject.name = argument;
  const gaussian::GaussianReader reader = value_or_exit(gaussian::GaussianReader::open(input));
  if (reader.traits().antialiased) subject.convention = reference::GaussianConvention::kAntialiased;
  if (reader.traits().flat) subject.convention = reference::GaussianConvention::kFlat;
  subject.built = testing::build_and_open(input, folder / "model.surf");
  return subject;
}

LightPicture codes_of(const picture::Image& image) {
  LightPicture picture(image.width, image.height);
  for (size_t i = 0; i < picture.pixels.size(); ++i) {
    glm::u8vec4 p;
    std::memcpy(&p, image.pixels.data() + 4 * i, 4);
    picture.pixels[i] = glm::dvec4(p) / 255.0;
  }
  return picture;
}

geometry::Camera camera_of(const Subject& subject, const View& view) {
  geometry::Camera camera = model::fit_model(*subject.built, 1);
  camera.position = camera.focal_point + view.distance * (camera.position - camera.focal_point);
  camera.view_angle = view.angle;
  return camera;
}

void study(render::Renderer& renderer, const Subject& subject, const View& view) {
  picture::PictureRequest request;
  request.camera = camera_of(subject, view);
  request.width = request.height = kSide;
  const auto drawn = [&](picture::SplatConvention convention, double spacing) {
    request.splat_convention = convention;
    request.spacing = spacing;
    return codes_of(draw_or_exit(renderer, subject.built, request).image);
  };
  const geometry::CameraFrame frame = value_or_exit(geometry::make_camera_frame(*request.camera, kSide, kSide));
  const LightPicture trained = drawn(picture::SplatConvention::kTrained, 0);
  const LightPicture exact = drawn(picture::SplatConvention::kExact, 0);
  const LightPicture ideal = reference::ideal_picture(subject.model, frame, kRays);
  const auto error = [&](const LightPicture& picture, const LightPicture& expected) {
    return reference::covered_psnr_of_codes(picture, expected);
  };
  std::printf("| %s, %s | %.1f | %.1f | %.1f | %.1f | %.1f | %.1f |\n", subject.name.c_str(), view.name,
              error(trained, reference::draw_as_trained(subject.model, frame, subject.convention)),
              error(exact, reference::draw_exactly(subject.model, frame)), error(trained, ideal), error(exact, ideal),
              error(drawn(picture::SplatConvention::kTrained, 1), ideal),
              error(drawn(picture::SplatConvention::kExact, 1), ideal));
  std::fflush(stdout);
}

}  // namespace
}  // namespace surfcast::bench

int main(int argc, char** argv) {
  using namespace surfcast;
  using namespace surfcast::bench;
  if (argc < 3) {
    std::fprintf(stderr, "usage: gaussian_study FOLDER FILE|ball|fog|needles|near...\n");
    return 2;
  }
  const std::unique_ptr<render::Renderer> renderer = value_or_exit(render::Renderer::create({}));
  std::printf(
      "| model, view | trained: rules | exact: footprints | trained: rays | exact: rays "
      "| trained at 1 px: rays | exact at 1 px: rays |\n|---|---|---|---|---|---|---|\n");
  for (int i = 2; i < argc; ++i) {
    const Subject subject = subject_of(argv[i], argv[1]);
    for (const View& view : kViews) study(*renderer, subject, view);
    renderer->release_model(*subject.built);
  }
  return 0;
}
