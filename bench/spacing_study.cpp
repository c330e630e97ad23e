// spacing_study PLOT.svg MODEL...: measures the loss of accuracy and the gain of speed by a coarser spacing. For each
// model and three views, compares the pictures at spacings of 0.5, 1, 2 and 4 pixels with the one at spacing 0: PSNR,
// surfels drawn, milliseconds. Prints a Markdown table and plots PSNR against spacing.

#include <array>
#include <fstream>
#include <string>

#include "base/stopwatch.h"
#include "bench_support.h"
#include "picture_error.h"

namespace surfcast::bench {
namespace {

constexpr std::array kSpacings{0.5, 1.0, 2.0, 4.0};
constexpr double kPlottedAsEqual = 70;  // dB

struct View {
  const char* name;
  double angle;     ///< rotation about the vertical axis from the view that fits the model, radians
  double distance;  ///< of the eye, relative to the view that fits the model
};
constexpr std::array kViews{View{"half as far", 0.6, 0.5}, View{"whole", 0, 1}, View{"from afar", -0.9, 2.5}};

struct Curve {
  std::string name;
  std::array<double, kSpacings.size()> psnr{};
};

glm::dvec3 turned(const glm::dvec3& v, const glm::dvec3& axis, double angle) {
  return v * std::cos(angle) + glm::cross(axis, v) * std::sin(angle) + axis * glm::dot(axis, v) * (1 - std::cos(angle));
}

geometry::Camera camera_of(const geometry::Camera& fit, const View& view) {
  geometry::Camera camera = fit;
  camera.position =
      fit.focal_point + view.distance * turned(fit.position - fit.focal_point, glm::normalize(fit.view_up), view.angle);
  return camera;
}

void print_row(const std::string& name, double spacing, const picture::Frame& frame, double error) {
  std::printf("| %s | %g | %s | %llu | %u | %.0f |\n", name.c_str(), spacing,
              std::isinf(error) ? (spacing == 0 ? "" : "equal") : std::to_string(error).substr(0, 4).c_str(),
              static_cast<unsigned long long>(frame.stats.surfels_drawn), frame.stats.blocks_drawn, drawing_ms(frame));
}

/// Draws a picture twice; returns the second one, for which all blocks and buffers are resident.
picture::Frame draw_warm(render::Renderer& renderer, const std::shared_ptr<const model::ModelFile>& model,
                         const picture::PictureRequest& request) {
  draw_or_exit(renderer, model, request);
  return draw_or_exit(renderer, model, request);
}

Curve study(render::Renderer& renderer, const std::shared_ptr<const model::ModelFile>& model, const View& view,
            picture::PictureRequest request, const geometry::Camera& fit) {
  Curve curve{model->path().stem().string() + ", " + view.name, {}};
  request.camera = camera_of(fit, view);
  request.spacing = 0;
  const picture::Frame finest = draw_warm(renderer, model, request);
  print_row(curve.name, 0, finest, std::numeric_limits<double>::infinity());
  for (size_t i = 0; i < kSpacings.size(); ++i) {
    request.spacing = kSpacings[i];
    const picture::Frame frame = draw_warm(renderer, model, request);
    const double error = psnr(frame.image, finest.image);
    print_row(curve.name, kSpacings[i], frame, error);
    curve.psnr[i] = std::min(error, kPlottedAsEqual);
  }
  return curve;
}

/// Plot of PSNR against spacing; the spacing axis is logarithmic.
class Plot {
 public:
  explicit Plot(const std::string& path) : out_(path) {
    out_ << "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 760 420\" font-family=\"sans-serif\" "
            "font-size=\"12\">\n<rect width=\"760\" height=\"420\" fill=\"white\"/>\n";
    for (int db = 20; db <= 70; db += 10) {
      line(x(0), y(db), x(kSpacings.size() - 1), y(db), "#ddd");
      text(20, y(db) + 4, db == 70 ? "equal" : std::to_string(db) + " dB");
    }
    for (size_t i = 0; i < kSpacings.size(); ++i) {
      text(x(i) - 12, 400, std::to_string(kSpacings[i]).substr(0, 3) + " px");
    }
  }
  ~Plot() { out_ << "</svg>\n"; }
  Plot(const Plot&) = delete;
  Plot& operator=(const Plot&) = delete;

  void add(const Curve& curve) {
    constexpr std::array kColors{"#1b6ca8", "#4a9bd1", "#9cc9e8", "#b04a2f", "#d98162",
                                 "#efbfae", "#3d7d3a", "#78b072", "#b9dbb5"};
    const char* color = kColors[curves_ % kColors.size()];
    for (size_t i = 0; i + 1 < kSpacings.size(); ++i) {
      line(x(i), y(curve.psnr[i]), x(i + 1), y(curve.psnr[i + 1]), color, 2);
    }
    const double row = 40 + 20 * static_cast<double>(curves_++);
    line(530, row - 4, 550, row - 4, color, 3);
    text(556, row, curve.name);
  }

 private:
  static double x(size_t i) { return 80 + 140 * static_cast<double>(i); }
  static double y(double db) { return 380 - (db - 20) * 7; }
  void line(double x0, double y0, double x1, double y1, const char* color, int width = 1) {
    out_ << "<line x1=\"" << x0 << "\" y1=\"" << y0 << "\" x2=\"" << x1 << "\" y2=\"" << y1 << "\" stroke=\"" << color
         << "\" stroke-width=\"" << width << "\"/>\n";
  }
  void text(double x0, double y0, const std::string& words) {
    out_ << "<text x=\"" << x0 << "\" y=\"" << y0 << "\">" << words << "</text>\n";
  }

  std::ofstream out_;
  size_t curves_ = 0;
};

}  // namespace
}  // namespace surfcast::bench

int main(int argc, char** argv) {
  using namespace surfcast;
  using namespace surfcast::bench;
  if (argc < 3) {
    std::fprintf(stderr, "usage: spacing_study PLOT.svg MODEL...\n");
    return 2;
  }
  const std::unique_ptr<render::Renderer> renderer = value_or_exit(render::Renderer::create({}));
  Plot plot(argv[1]);
  std::printf("%s, 1280 x 720\n\n| view | spacing | PSNR | surfels | blocks | ms |\n|---|---|---|---|---|---|\n",
              renderer->device().renderer.c_str());
  for (int i = 2; i < argc; ++i) {
    const std::shared_ptr<const model::ModelFile> model = open_or_exit(argv[i]);
    picture::PictureRequest request;
    request.spacing = 8;
    const geometry::Camera fit = draw_or_exit(*renderer, model, request).camera;
    for (const View& view : kViews) plot.add(study(*renderer, model, view, request, fit));
    renderer->release_model(*model);
  }
  return 0;
}
