#include "scattered/read_samples.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <string_view>
#include <utility>
#include <variant>

#include "ellipsoid/tensor.h"
#include "estimation/neighbours.h"
#include "estimation/sites.h"
#include "geometry/box.h"
#include "scan/column_names.h"

namespace surfcast::scattered {
namespace {

/// Neighbours within the reach of a kernel whose size the spacing gives: the usual number for the spline in three
/// dimensions is 30 to 60.
constexpr size_t kNeighbours = estimation::kLargestDegree;

constexpr std::array<std::string_view, 6> kTensorParts{"_xx", "_xy", "_xz", "_yy", "_yz", "_zz"};

bool same_name(std::string_view a, std::string_view b) {
  return scan::attribute_key(a) == scan::attribute_key(b);
}

/// The name of the scan's column, as the scan has it; none if it has no such column.
std::optional<std::string> column_named(const scan::ScanSchema& schema, std::string_view name) {
  for (const scan::ScalarField& field : schema.scalars) {
    if (same_name(field.name, name)) return field.name;
  }
  if (schema.radii && same_name(name, "radius")) return "radius";
  return std::nullopt;
}

std::vector<std::string> size_columns(const KernelSizes& sizes) {
  if (sizes.length || sizes.meaning == KernelSize::kSpacing) return {};
  if (sizes.meaning != KernelSize::kCovariance) return {sizes.column};
  std::vector<std::string> names;
  names.reserve(kTensorParts.size());
  for (const std::string_view part : kTensorParts) names.push_back(sizes.column + std::string(part));
  return names;
}

/// The values of a column of one piece. Radii have a place of their own among the points of a scan.
std::vector<double> column_of(const scan::ScanPoints& points, std::string_view name) {
  for (const surfel::ScalarAttribute& scalar : points.scalars) {
    if (!same_name(scalar.name, name)) continue;
    return std::visit([](const auto& typed) { return std::vector<double>(typed.begin(), typed.end()); }, scalar.values);
  }
  return {points.radii.begin(), points.radii.end()};
}

ellipsoid::SymmetricTensor round_shape(double size) {
  return {size * size, 0, 0, size * size, 0, size * size};
}

/// Of a size as it is stated. A radius is twice the smoothing length.
ellipsoid::SymmetricTensor shape_of(KernelSize meaning, std::span<const double> stated) {
  if (meaning == KernelSize::kCovariance) {
    return {stated[0], stated[1], stated[2], stated[3], stated[4], stated[5]};
  }
  return round_shape(meaning == KernelSize::kRadius ? 0.5 * stated[0] : stated[0]);
}

/// Rounding may leave the least eigenvalue of a flat kernel below 0.
bool is_shape(KernelSize meaning, std::span<const double> stated) {
  constexpr double kRounding = 1e-6;
  if (!std::ranges::all_of(stated, [](double part) { return std::isfinite(part); })) return false;
  if (meaning != KernelSize::kCovariance) return stated[0] > 0 && std::isfinite(stated[0] * stated[0]);
  const glm::dvec3 values = ellipsoid::eigen_system(shape_of(meaning, stated)).values;
  return values[0] > 0 && values[2] >= -kRounding * values[0];
}

class SampleReader {
 public:
  SampleReader(const FieldOptions& options, KernelSizes sizes)
      : options_(options), sizes_(std::move(sizes)), names_(size_columns(sizes_)) {
    samples_.profile = profile_of(sizes_.meaning);
  }

  void add(const scan::ScanPoints& points) {
    const std::vector<double> values = column_of(points, options_.value);
    const std::vector<double> weights =
        options_.weight.empty() ? std::vector<double>() : column_of(points, options_.weight);
    std::vector<std::vector<double>> columns;
    for (const std::string& name : names_) columns.push_back(column_of(points, name));
    std::array<double, kTensorParts.size()> stated{1, 0, 0, 1, 0, 1};
    if (sizes_.length) stated[0] = *sizes_.length;
    for (size_t i = 0; i < points.size(); ++i) {
      for (size_t c = 0; c < columns.size(); ++c) stated.at(c) = columns[c][i];
      add(points.positions[i], values[i], weights.empty() ? 1 : weights[i], stated);
    }
  }

  Samples take() && { return std::move(samples_); }

 private:
  void add(const glm::dvec3& place, double value, double weight, std::span<const double> stated) {
    const bool finite = std::isfinite(place.x) && std::isfinite(place.y) && std::isfinite(place.z) &&
                        std::isfinite(value) && std::isfinite(weight);
    if (!finite || !is_shape(sizes_.meaning, stated)) {
      ++samples_.skipped;
      return;
    }
    samples_.kernels.push_back({place, shape_of(sizes_.meaning, stated), value, weight});
  }

  const FieldOptions& options_;
  const KernelSizes sizes_;
  const std::vector<std::string> names_;
  Samples samples_;
};

/// Smoothing lengths so that kNeighbours samples are within the reach of each kernel; fewer samples count as if they
/// went on in all directions.
Status size_by_spacing(Samples& samples) {
  std::vector<glm::dvec3> places;
  geometry::Box box;
  for (const KernelSample& sample : samples.kernels) {
    places.push_back(sample.centre);
    box.include(sample.centre);
  }
  const estimation::Sites sites = estimation::find_sites(places, box);
  if (sites.size() < 2)
    return fail(ErrorKind::kInvalidInput, "one sample alone has no spacing; state a size of kernels");
  std::vector<double> lengths(sites.size());
  estimation::for_each_neighbourhood(sites, kNeighbours, [&](const estimation::Neighbours& near) {
    const double missing = static_cast<double>(kNeighbours) / static_cast<double>(near.ids.size());
    lengths[near.site] = 0.5 * std::cbrt(missing) * sites.unit * std::sqrt(near.squared_distances.back());
  });
  for (size_t i = 0; i < samples.kernels.size(); ++i) {
    samples.kernels[i].shape = round_shape(lengths[sites.of_point[i]]);
  }
  return {};
}

/// Kernels of the same integral.
void normalize(Samples& samples) {
  const double integral = integral_of(samples.profile);
  for (KernelSample& sample : samples.kernels) {
    const double volume = std::sqrt(std::max(glm::determinant(sample.shape.matrix()), 0.0));
    sample.amplitude = volume > 0 ? sample.amplitude / (integral * volume) : 0;
  }
}

Status check_columns(const scan::ScanSchema& schema, const FieldOptions& options, const KernelSizes& sizes) {
  std::vector<std::string> wanted = size_columns(sizes);
  wanted.push_back(options.value);
  if (!options.weight.empty()) wanted.push_back(options.weight);
  for (const std::string& name : wanted) {
    if (!column_named(schema, name)) return fail(ErrorKind::kInvalidInput, "has no column " + name);
  }
  return {};
}

Status read_pieces(const scan::ScanStream& scan, SampleReader& reader) {
  for (size_t piece = 0; piece < scan.pieces(); ++piece) {
    const Result<scan::ScanPoints> points = scan.read(piece);
    if (!points) return fail(points);
    reader.add(*points);
  }
  return {};
}

Status check_memory(uint64_t samples, uint64_t max_bytes) {
  if (samples <= max_bytes / kBytesPerSample) return {};
  return fail(ErrorKind::kLimit, std::to_string(samples) + " samples take " +
                                     std::to_string(samples * kBytesPerSample >> 20) +
                                     " MiB, more than the memory of the build; allow more with --memory");
}

}  // namespace

bool has_field(const scan::ScanSchema& schema, const FieldOptions& options) {
  return column_named(schema, options.value).has_value();
}

KernelSizes usual_sizes(const scan::ScanSchema& schema) {
  for (const char* name : {"smoothing_length", "hsml", "h"}) {
    if (auto column = column_named(schema, name)) return {KernelSize::kSmoothingLength, std::move(*column), {}};
  }
  if (column_named(schema, "radius")) return {KernelSize::kRadius, "radius", {}};
  if (auto column = column_named(schema, "sigma")) return {KernelSize::kDeviation, std::move(*column), {}};
  const bool covariances = std::ranges::all_of(
      kTensorParts, [&](std::string_view part) { return column_named(schema, "cov" + std::string(part)).has_value(); });
  if (covariances) return {KernelSize::kCovariance, "cov", {}};
  return {};
}

Result<Samples> read_samples(const scan::ScanStream& scan, const std::filesystem::path& path,
                             const FieldOptions& options, uint64_t max_bytes) {
  const auto named = [&path](const Error& error) { return fail(error.kind, path.string() + ": " + error.message); };
  const KernelSizes sizes = options.sizes.value_or(usual_sizes(scan.schema()));
  if (Status status = check_columns(scan.schema(), options, sizes); !status) return named(status.error());
  if (Status status = check_memory(scan.size(), max_bytes); !status) return named(status.error());
  SampleReader reader(options, sizes);
  if (Status status = read_pieces(scan, reader); !status) return fail(status);
  Samples samples = std::move(reader).take();
  if (samples.kernels.empty()) {
    return named({ErrorKind::kInvalidInput, "no point has a finite place and value and a size above 0"});
  }
  if (sizes.meaning == KernelSize::kSpacing) {
    if (Status status = size_by_spacing(samples); !status) return named(status.error());
  }
  if (options.combination == Combination::kDensity) normalize(samples);
  return samples;
}

}  // namespace surfcast::scattered
