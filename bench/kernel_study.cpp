// Draws every scene of tests/reference with many values of the kernel's constants and prints the error of each picture
// against the ideal one, as the Markdown tables of docs/kernel.md. Takes minutes.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <string>
#include <vector>

#include "estimation/neighbours.h"
#include "reference/reference_renderer.h"
#include "reference/scenes.h"
#include "surfel/even_sampling.h"

namespace surfcast::reference {
namespace {

/// A scene with its precomputed ideal picture and coverage, which do not depend on the constants.
struct Subject {
  Scene scene;
  SrgbPicture ideal;
  std::vector<double> inside;  ///< share of each pixel that the surface covers
};

struct Choice {
  std::string name;
  KernelParameters kernel;
};

std::vector<Subject> make_subjects() {
  std::vector<Subject> subjects;
  for (const std::string& name : scene_names()) {
    Scene scene = make_scene(name);
    SrgbPicture ideal = encode(ideal_picture(scene));
    std::vector<double> inside = ideal_coverage(scene);
    subjects.push_back({std::move(scene), std::move(ideal), std::move(inside)});
  }
  return subjects;
}

/// Percentage of the pixels inside the surface that are not fully covered.
double uncovered_percent(const Subject& subject, const ReferencePicture& result) {
  size_t inside = 0;
  size_t uncovered = 0;
  for (size_t i = 0; i < subject.inside.size(); ++i) {
    if (subject.inside[i] < 0.9999) continue;
    ++inside;
    uncovered += result.weights[i] < 1 ? 1 : 0;
  }
  return 100.0 * static_cast<double>(uncovered) / static_cast<double>(std::max<size_t>(inside, 1));
}

void print_header(const std::vector<Subject>& subjects) {
  std::printf("\n| |");
  for (const Subject& s : subjects) std::printf(" %s |", s.scene.name.c_str());
  std::printf("\n|---|");
  for (size_t i = 0; i < subjects.size(); ++i) std::printf("---|");
  std::printf("\n");
}

/// Prints a table row. A cell states the PSNR in dB, fragments per pixel in brackets, and the percentage of uncovered
/// pixels inside the surface, if any.
void print_row(const std::vector<Subject>& subjects, const Choice& choice) {
  std::printf("| %s |", choice.name.c_str());
  for (const Subject& s : subjects) {
    const ReferencePicture result = render(s.scene.cloud, s.scene.request, choice.kernel);
    const double pixels = static_cast<double>(result.weights.size());
    std::printf(" %.1f (%.1f)", psnr(encode(result.picture), s.ideal), static_cast<double>(result.fragments) / pixels);
    const double uncovered = uncovered_percent(s, result);
    if (uncovered > 0) std::printf(" %.2g %%", uncovered);
    std::printf(" |");
    std::fflush(stdout);
  }
  std::printf("\n");
}

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%g", value);
  return text;
}

/// A kernel with sigma in units of h and the same cutoff for every gain.
Choice kernel_choice(double sigma_in_spacings, double cutoff) {
  Choice choice{number(sigma_in_spacings) + " h, " + number(cutoff), {}};
  choice.kernel.sigma = sigma_in_spacings / surfel::kRadiusOverSpacing;
  choice.kernel.cutoff_minified = choice.kernel.cutoff_magnified = cutoff;
  return choice;
}

/// The default constants with one of them changed.
Choice varied(double KernelParameters::*constant, const std::string& name, double value) {
  Choice choice{name + " " + number(value), {}};
  choice.kernel.*constant = value;
  return choice;
}

void study(const std::vector<Subject>& subjects, const char* title, const std::vector<Choice>& choices) {
  std::printf("\n%s\n", title);
  print_header(subjects);
  for (const Choice& choice : choices) print_row(subjects, choice);
}

std::vector<Choice> variations(double KernelParameters::*constant, const char* name, std::vector<double> values) {
  std::vector<Choice> choices;
  for (const double value : values) choices.push_back(varied(constant, name, value));
  return choices;
}

/// The colours that magnified kernels reconstruct at the sites from one coefficient per site.
std::vector<glm::dvec3> reconstructed(const estimation::Sites& sites, const estimation::NeighbourGraph& graph,
                                      const std::vector<double>& radii, const std::vector<glm::dvec3>& coefficients) {
  const KernelParameters kernel;
  const double rim = std::exp(-0.5 * kernel.cutoff_magnified);
  std::vector<glm::dvec3> result = coefficients;
  for (size_t i = 0; i < sites.size(); ++i) {
    double sum = 1 - rim;
    glm::dvec3 color = sum * coefficients[i];
    for (const uint32_t j : graph.of(i)) {
      const double distance = glm::distance(sites.positions[i], sites.positions[j]) * sites.unit;
      const double r2 = std::pow(distance / (kernel.sigma * radii[j]), 2);
      const double weight = std::max(std::exp(-0.5 * r2) - rim, 0.0);
      sum += weight;
      color += weight * coefficients[j];
    }
    result[i] = color / sum;
  }
  return result;
}

/// Adjusts the colours so that their reconstruction is closer to the samples: w += sample - reconstruction ("Surface
/// Splatting", Zwicker et al. 2001, section 4). The colours are stored with 8 bits, as samples are.
void correct_colors(surfel::SurfelCloud& cloud, int times) {
  constexpr size_t kNeighbours = 24;
  const estimation::Sites sites = estimation::find_sites(cloud.positions, cloud.bounds());
  const estimation::NeighbourGraph graph = estimation::find_neighbours(sites, kNeighbours);
  std::vector<double> radii(sites.size());
  std::vector<glm::dvec3> samples(sites.size());
  for (size_t i = 0; i < cloud.size(); ++i) {
    radii[sites.of_point[i]] = cloud.radii[i];
    samples[sites.of_point[i]] = linear_from_srgb8(glm::dvec3(cloud.colors->values[i]));
  }
  std::vector<glm::dvec3> coefficients = samples;
  for (int k = 0; k < times; ++k) {
    const std::vector<glm::dvec3> now = reconstructed(sites, graph, radii, coefficients);
    for (size_t i = 0; i < sites.size(); ++i) coefficients[i] += samples[i] - now[i];
  }
  for (size_t i = 0; i < cloud.size(); ++i) {
    const glm::dvec3 color = glm::clamp(coefficients[sites.of_point[i]], 0.0, 1.0);
    cloud.colors->values[i] = glm::u16vec3(srgb8_from_linear(color));
  }
}

void study_coefficients(std::vector<Subject> subjects) {
  std::erase_if(subjects, [](const Subject& s) { return !s.scene.cloud.colors || s.scene.cloud.colors->bits != 8; });
  std::printf("\nCoefficients corrected so many times\n");
  print_header(subjects);
  print_row(subjects, {"0", {}});
  for (const int times : {1, 2}) {
    std::vector<Subject> corrected = subjects;
    for (Subject& s : corrected) correct_colors(s.scene.cloud, times);
    print_row(corrected, {number(times), {}});
  }
}

void run() {
  const std::vector<Subject> subjects = make_subjects();
  study(subjects, "The constants of kernel.h", {{"chosen", {}}});
  std::vector<Choice> kernels;
  for (const auto& [sigma, cutoff] : {std::pair{1.0, 2.0},
                                      {1.0, 4.0},
                                      {0.55, 4.0},
                                      {0.55, 9.0},
                                      {0.45, 4.0},
                                      {0.45, 9.0},
                                      {0.41, 9.0},
                                      {0.41, 12.0},
                                      {0.37, 9.0},
                                      {0.37, 12.0},
                                      {0.32, 12.0}}) {
    kernels.push_back(kernel_choice(sigma, cutoff));
  }
  study(subjects, "Kernel: sigma, cutoff at every gain", kernels);
  using K = KernelParameters;
  study(subjects, "Sigma alone", variations(&K::sigma, "sigma / r", {0.31, 0.33, 0.35, 0.37, 0.40, 0.45}));
  study(subjects, "Cutoff, minified", variations(&K::cutoff_minified, "cutoff", {3, 4, 5, 6}));
  study(subjects, "Cutoff, magnified", variations(&K::cutoff_magnified, "cutoff", {7, 9, 12, 16}));
  study(subjects, "Disc radius", variations(&K::visibility_radius, "radius / r", {0.6, 0.8, 1.0, 1.2}));
  study(subjects, "Disc pixels", variations(&K::visibility_pixels, "pixels", {0.4, 0.5, 0.6, 0.7}));
  study(subjects, "Disc depth", variations(&K::visibility_depth, "depth / r", {0.25, 0.5, 0.75, 1.0, 1.5}));
  study(subjects, "Coverage, minified", variations(&K::coverage_minified, "sum", {0.5, 0.6, 0.7, 0.8, 0.9}));
  study(subjects, "Coverage, magnified", variations(&K::coverage_magnified, "sum", {0.02, 0.03, 0.05, 0.1}));
  study_coefficients(subjects);
}

}  // namespace
}  // namespace surfcast::reference

int main() {
  surfcast::reference::run();
}
