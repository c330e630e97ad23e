#include "lab/methods.h"

#include <cmath>
#include <cstring>
#include <glm/vec4.hpp>

#include "base/contract.h"
#include "base/stopwatch.h"
#include "bench_support.h"
#include "lab/srgb_pictures.h"

namespace surfcast::lab {
namespace {

/// The kernel of the papers: a standard deviation of one spacing h (r = 1.08 h), cut at r^2 = 2, and always normalized
/// by the sum of weights, however small.
constexpr const char* kPapersKernel = R"(
#define SURFCAST_OTHER_KERNEL
#define SURFCAST_KERNEL_SIGMA 0.9259
#define SURFCAST_KERNEL_CUTOFF_MINIFIED 2.0
#define SURFCAST_KERNEL_CUTOFF 2.0
#define SURFCAST_COVERAGE_MINIFIED 1e-4
#define SURFCAST_COVERAGE_MAGNIFIED 1e-4
)";

struct Method {
  MethodFacts facts;
  std::optional<PlainShape> plain{};
  bool papers = false;
  void (*adapt)(picture::PictureRequest&) = [](picture::PictureRequest&) {};
};

const std::vector<Method>& methods() {
  static const std::vector<Method> list{
      {{"points", "GL points, squares as wide as the discs", true}, PlainShape::kPoint},
      {{"discs", "opaque discs in the surfels' planes", true}, PlainShape::kDisc},
      {{"no prefilter", "`--filter none`: splats without prefilter", true},
       {},
       false,
       [](picture::PictureRequest& r) { r.filter = picture::Filter::kNone; }},
      {{"papers' kernel", "per-pixel EWA with sigma = h, cutoff 2, as in Ren 2002", false}, {}, true},
      {{"per surfel", "`--normalization surfel`", false},
       {},
       false,
       [](picture::PictureRequest& r) { r.normalization = picture::Normalization::kSurfel; }},
      {{"per pixel", "EWA as it is by default", false}},
      {{"at rest", "the same with silhouettes as means of four samples, as `render` and the last picture of a rest",
        false},
       {},
       false,
       [](picture::PictureRequest& r) { r.silhouettes = true; }},
      {{"1/2 px", "the same at `--spacing 0.5`", false},
       {},
       false,
       [](picture::PictureRequest& r) { r.spacing = 0.5; }},
      {{"1 px", "`--spacing 1`", false}, {}, false, [](picture::PictureRequest& r) { r.spacing = 1; }},
      {{"2 px", "`--spacing 2`", false}, {}, false, [](picture::PictureRequest& r) { r.spacing = 2; }},
  };
  return list;
}

const Method& method_named(const std::string& name) {
  const auto found = std::ranges::find_if(methods(), [&](const Method& m) { return m.facts.name == name; });
  SURFCAST_EXPECTS(found != methods().end());
  return *found;
}

/// A picture from bytes whose rows run from bottom to top.
SrgbPicture flipped_picture(const std::vector<std::byte>& bytes, int width, int height) {
  SrgbPicture picture{width, height, {}};
  const auto* pixels = reinterpret_cast<const glm::u8vec4*>(bytes.data());
  for (int y = height - 1; y >= 0; --y) {
    for (int x = 0; x < width; ++x) picture.pixels.emplace_back(pixels[static_cast<size_t>(y) * width + x]);
  }
  return picture;
}

constexpr int kSamples = 4;  ///< per supersampled pixel, along each axis

/// Weights of the samples within four pixels of a pixel's centre. The variance is that of the pixel prefilter minus
/// that of the prefilter of the samples.
std::vector<double> sample_weights() {
  constexpr int kReach = 4;  // pixels
  constexpr double kVariance = kSamples * kSamples - 1;
  std::vector<double> weights;
  double sum = 0;
  for (int i = -kReach * kSamples; i < (kReach + 1) * kSamples; ++i) {
    const double x = i + 0.5 - 0.5 * kSamples;
    weights.push_back(std::exp(-0.5 * x * x / kVariance));
    sum += weights.back();
  }
  for (double& weight : weights) weight /= sum;
  return weights;
}

/// Filters and downsamples by kSamples along x, and exchanges x and y. The outside of the picture is background.
reference::LinearPicture filtered_along_x(const reference::LinearPicture& samples) {
  const std::vector<double> weights = sample_weights();
  const int reach = static_cast<int>(weights.size() - kSamples) / 2;
  reference::LinearPicture result(samples.height, samples.width / kSamples);
  for (int y = 0; y < samples.height; ++y) {
    for (int x = 0; x < result.height; ++x) {
      glm::dvec3 sum{0};
      const int first = x * kSamples - reach;
      for (int i = std::max(-first, 0); i < static_cast<int>(weights.size()) && first + i < samples.width; ++i) {
        sum += weights[static_cast<size_t>(i)] * samples.pixels[samples.index(first + i, y)];
      }
      result.pixels[result.index(y, x)] = sum;
    }
  }
  return result;
}

reference::LinearPicture linear_picture_of(const picture::Image& image) {
  reference::LinearPicture picture(image.width, image.height);
  for (size_t i = 0; i < picture.pixels.size(); ++i) {
    glm::vec4 pixel;
    std::memcpy(&pixel, image.pixels.data() + i * sizeof pixel, sizeof pixel);
    picture.pixels[i] = glm::dvec3(pixel);
  }
  return picture;
}

}  // namespace

Methods::Methods() : ours_({}), papers_({.shader_defines = kPapersKernel}) {
  ours_.run([this](render::Renderer& renderer) { device_ = renderer.device().renderer; });
}

Methods::~Methods() {
  ours_.run([this](render::Renderer&) { rasterizer_.reset(); });
}

std::vector<MethodFacts> Methods::all() {
  std::vector<MethodFacts> facts;
  for (const Method& method : methods()) facts.push_back(method.facts);
  return facts;
}

void Methods::open(std::shared_ptr<const model::ModelFile> model) {
  const std::shared_ptr<const model::ModelFile> last = std::exchange(model_, std::move(model));
  ours_.run([&](render::Renderer& renderer) {
    rasterizer_.reset();
    if (last) renderer.release_model(*last);
  });
  if (last) papers_.run([&](render::Renderer& renderer) { renderer.release_model(*last); });
}

picture::Frame Methods::draw_frame(RendererThread& thread, const picture::PictureRequest& request) {
  picture::Frame frame;
  thread.run([&](render::Renderer& renderer) { frame = bench::draw_or_exit(renderer, model_, request); });
  return frame;
}

geometry::Camera Methods::camera_of(const picture::PictureRequest& request) {
  picture::PictureRequest coarse = request;
  coarse.spacing = 8;
  return draw_frame(ours_, coarse).camera;
}

DrawnPicture Methods::draw_plain(PlainShape shape, const picture::PictureRequest& request) {
  const geometry::CameraFrame frame =
      bench::value_or_exit(geometry::make_camera_frame(*request.camera, request.width, request.height));
  DrawnPicture drawn;
  ours_.run([&](render::Renderer&) {
    if (!rasterizer_ || painted_ != glm::ivec2(request.width, request.height)) {
      rasterizer_ = std::make_unique<PlainRasterizer>(*model_, request.width, request.height);
      painted_ = {request.width, request.height};
    }
    std::vector<std::byte> pixels;
    const Stopwatch watch;
    const double start = bench::processor_ms();
    rasterizer_->draw(shape, PlainFaces::kFront, frame, pixels);
    drawn.milliseconds = watch.milliseconds();
    drawn.processor_milliseconds = bench::processor_ms() - start;
    drawn.picture = flipped_picture(pixels, request.width, request.height);
  });
  drawn.splats = model_->info().surfels;
  return drawn;
}

DrawnPicture Methods::draw(const std::string& name, const picture::PictureRequest& request) {
  const Method& method = method_named(name);
  if (method.plain) return draw_plain(*method.plain, request);
  picture::PictureRequest adapted = request;
  method.adapt(adapted);
  const Stopwatch watch;
  const double start = bench::processor_ms();
  const picture::Frame frame = draw_frame(method.papers ? papers_ : ours_, adapted);
  const double milliseconds = watch.milliseconds();
  const double processor = bench::processor_ms() - start;
  return {picture_of(frame.image), milliseconds, processor, frame.stats.stages, frame.stats.surfels_drawn};
}

SrgbPicture Methods::supersampled(const picture::PictureRequest& request) {
  picture::PictureRequest larger = request;
  larger.width *= kSamples;
  larger.height *= kSamples;
  larger.format = picture::PixelFormat::kLinearFloat;
  const picture::Frame frame = draw_frame(ours_, larger);
  return encode(filtered_along_x(filtered_along_x(linear_picture_of(frame.image))));
}

}  // namespace surfcast::lab
