#include "gaussian/gaussian_scenes.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include <gtest/gtest.h>

#include "builder/build_model.h"
#include "gaussian/gaussian_files.h"

namespace surfcast::testing {
namespace {

double rounded(double value) {
  return static_cast<double>(static_cast<float>(value));
}

glm::dvec3 rounded(const glm::dvec3& v) {
  return {rounded(v.x), rounded(v.y), rounded(v.z)};
}

void append(const glm::dvec3& v, std::vector<float>& row) {
  for (int axis = 0; axis < 3; ++axis) row.push_back(static_cast<float>(v[axis]));
}

std::vector<float> row_of(const reference::GaussianSplat& splat, int degree, bool flat) {
  std::vector<float> row;
  append(splat.position, row);
  append(glm::dvec3(0), row);  // a normal, which no reader uses
  append(splat.harmonics[0], row);
  for (int channel = 0; channel < 3; ++channel) {
    for (int i = 1; i < (degree + 1) * (degree + 1); ++i) {
      row.push_back(static_cast<float>(splat.harmonics.at(static_cast<size_t>(i))[channel]));
    }
  }
  row.push_back(static_cast<float>(splat.logit));
  append(splat.log_scale, row);
  if (flat) row.pop_back();
  const glm::dquat& q = splat.rotation;
  for (const double part : {q.w, q.x, q.y, q.z}) row.push_back(static_cast<float>(part));
  return row;
}

/// The nearest byte.
char byte_of(double value) {
  return static_cast<char>(static_cast<uint8_t>(std::lround(std::clamp(value, 0.0, 255.0))));
}

/// A signed number of 24 bits with 12 behind the point.
std::string fixed_point(double value) {
  const auto bits = static_cast<uint32_t>(std::lround(value * 4096));
  return {static_cast<char>(bits), static_cast<char>(bits >> 8), static_cast<char>(bits >> 16)};
}

}  // namespace

reference::GaussianModel in_single_precision(reference::GaussianModel model) {
  for (reference::GaussianSplat& splat : model.splats) {
    splat.position = rounded(splat.position);
    splat.log_scale = rounded(splat.log_scale);
    splat.logit = rounded(splat.logit);
    const glm::dquat& q = splat.rotation;
    splat.rotation = {rounded(q.w), rounded(q.x), rounded(q.y), rounded(q.z)};
    for (glm::dvec3& harmonic : splat.harmonics) harmonic = rounded(harmonic);
  }
  return model;
}

reference::GaussianModel reference_model(const std::filesystem::path& path) {
  const gaussian::Gaussians all = read_whole(path);
  if (all.size() == 0) return {};
  const size_t stored = all.harmonics.size() / 3 / all.size();
  reference::GaussianModel model;
  while (model.degree < 3 && gaussian::harmonics_of(model.degree) < stored) ++model.degree;
  for (size_t i = 0; i < all.size(); ++i) {
    reference::GaussianSplat splat;
    const double opacity{all.opacities[i]};
    splat.position = all.positions[i];
    splat.log_scale = glm::log(glm::dvec3(all.scales[i]));
    splat.rotation = glm::dquat(all.rotations[i]);
    splat.logit = std::log(opacity / (1 - opacity));
    for (size_t k = 0; k < std::min<size_t>(stored, reference::kHarmonics); ++k) {
      const float* c = &all.harmonics[3 * (i * stored + k)];
      splat.harmonics.at(k) = glm::dvec3(c[0], c[1], c[2]);
    }
    model.splats.push_back(splat);
  }
  return model;
}

std::filesystem::path write_ply(const std::filesystem::path& path, const reference::GaussianModel& model, bool flat) {
  std::vector<std::vector<float>> rows;
  for (const reference::GaussianSplat& splat : model.splats) rows.push_back(row_of(splat, model.degree, flat));
  return write(path, float_ply(gaussian_properties(model.degree, flat ? 2 : 3), rows));
}

std::filesystem::path write_antialiased_spz(const std::filesystem::path& path, const reference::GaussianModel& model) {
  SpzContent content;
  content.version = 2;
  content.count = static_cast<uint32_t>(model.splats.size());
  content.flags = 1;
  std::string positions;
  std::string opacities;
  std::string colors;
  std::string scales;
  std::string rotations;
  for (const reference::GaussianSplat& splat : model.splats) {
    const glm::dquat q = glm::normalize(splat.rotation) * (splat.rotation.w < 0 ? -1.0 : 1.0);
    opacities += byte_of(255 * reference::splat_opacity(splat));
    for (int axis = 0; axis < 3; ++axis) {
      positions += fixed_point(splat.position[axis]);
      colors += byte_of(255 * (0.5 + 0.15 * splat.harmonics[0][axis]));
      scales += byte_of(16 * (splat.log_scale[axis] + 10));
      rotations += byte_of(127.5 * (glm::dvec3(q.x, q.y, q.z)[axis] + 1));
    }
  }
  content.columns = {positions, opacities, colors, scales, rotations, ""};
  return write(path, spz(content));
}

ModelPointer build_and_open(const std::filesystem::path& input, const std::filesystem::path& target,
                            std::optional<uint64_t> memory) {
  builder::BuildOptions options;
  options.memory = memory;
  const auto report = builder::build_model(std::vector{input}, target, options, [](const builder::BuildStep&) {});
  EXPECT_TRUE(report) << (report ? "" : report.error().message);
  if (!report) return nullptr;
  Result<model::ModelFile> model = model::ModelFile::open(target);
  EXPECT_TRUE(model) << (model ? "" : model.error().message);
  return model ? std::make_shared<const model::ModelFile>(std::move(*model)) : nullptr;
}

picture::Frame draw(render::Renderer& renderer, const ModelPointer& model, const picture::PictureRequest& request) {
  const std::atomic<bool> never{false};
  Result<picture::Frame> frame = renderer.draw(model, request, never);
  EXPECT_TRUE(frame) << (frame ? "" : frame.error().message);
  return frame ? std::move(*frame) : picture::Frame{};
}

}  // namespace surfcast::testing
