#include "grid/nrrd_axes.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <map>
#include <utility>

#include "base/ascii_text.h"
#include "grid/header_text.h"
#include "scan/text_tokens.h"

namespace surfcast::grid {
namespace {

/// Vectors "(a,b,c)" and words "none", for axes or for the origin. Vectors of a plane get the third coordinate 0.
Result<std::vector<std::optional<glm::dvec3>>> parse_vectors(std::string_view text, size_t dimension) {
  std::vector<std::optional<glm::dvec3>> vectors;
  for (std::string_view rest = trimmed(text); !rest.empty(); rest = trimmed(rest)) {
    if (!rest.starts_with('(')) {
      const std::string_view word = scan::Tokens(rest).next();
      if (to_lower(word) != "none") return bad_header(kNrrd, "not a vector", rest);
      vectors.emplace_back(std::nullopt);
      rest.remove_prefix(word.size());
      continue;
    }
    const size_t end = rest.find(')');
    if (end == std::string_view::npos) return bad_header(kNrrd, "not a vector", rest);
    std::string inner(rest.substr(1, end - 1));
    for (char& c : inner) c = c == ',' ? ' ' : c;
    const auto numbers = numbers_of(inner);
    if (!numbers || numbers->size() != dimension) return bad_header(kNrrd, "not a vector of the space", rest);
    glm::dvec3 vector(0);
    for (size_t i = 0; i < dimension; ++i) vector[static_cast<int>(i)] = (*numbers)[i];
    vectors.emplace_back(vector);
    rest.remove_prefix(end + 1);
  }
  return vectors;
}

/// Numbers for all axes, NaN where the field is missing.
Result<std::vector<double>> per_axis(const NrrdFields& fields, std::string_view name, size_t axes) {
  if (!fields.contains(name)) return std::vector<double>(axes, std::numeric_limits<double>::quiet_NaN());
  auto numbers = numbers_of(field(fields, name));
  if (!numbers || numbers->size() != axes) return bad_header(kNrrd, "not a number for each axis", field(fields, name));
  return std::move(*numbers);
}

Status parse_kinds(const NrrdFields& fields, NrrdAxes& axes) {
  axes.kinds.resize(axes.sizes.size());
  axes.cells.resize(axes.sizes.size());
  const auto take = [&](std::string_view name, auto&& use) -> Status {
    const auto words = words_of(field(fields, name));
    if (words.empty()) return {};
    if (words.size() != axes.sizes.size()) {
      return bad_header(kNrrd, "not a word for each axis", field(fields, name));
    }
    for (size_t i = 0; i < words.size(); ++i) use(i, to_lower(words[i]));
    return {};
  };
  if (Status status = take("kinds", [&](size_t i, std::string word) { axes.kinds[i] = std::move(word); }); !status) {
    return status;
  }
  return take("centers", [&](size_t i, const std::string& word) { axes.cells[i] = word == "cell"; });
}

/// Kinds of axes along which a grid extends. An axis without a kind extends unless its direction is "none".
bool is_domain(const NrrdAxes& axes, size_t axis) {
  const std::string& kind = axes.kinds[axis];
  if (kind == "space" || kind == "domain") return true;
  if (!kind.empty() && kind != "???" && kind != "none") return false;
  return axes.directions.empty() || axes.directions[axis].has_value();
}

std::optional<SampleKind> tensor_named(std::string_view kind) {
  if (kind == "3d-symmetric-matrix") return SampleKind::kSymmetricTensor;
  if (kind == "3d-masked-symmetric-matrix") return SampleKind::kMaskedSymmetricTensor;
  if (kind == "3d-matrix") return SampleKind::kTensor;
  if (kind == "3d-masked-matrix") return SampleKind::kMaskedTensor;
  return std::nullopt;
}

/// What the components on this axis are. Only tensors have several.
Result<SampleKind> kind_of_axis(const NrrdAxes& axes, size_t axis) {
  if (axes.sizes[axis] == 1) return SampleKind::kScalar;
  const std::string& kind = axes.kinds[axis];
  const std::optional<SampleKind> tensor = tensor_named(kind);
  if (tensor && components_of(*tensor) == axes.sizes[axis]) return *tensor;
  const std::string named = kind.empty() ? "of no stated kind" : "of kind " + scan::printable(kind);
  return fail(ErrorKind::kUnsupported, "NRRD: samples of " + std::to_string(axes.sizes[axis]) + " components " + named +
                                           "; only scalars and tensors are read");
}

/// The step along an axis, and the position of its first sample, without a space.
std::pair<double, double> spacing_and_start(const NrrdAxes& axes, size_t axis) {
  const double min = axes.mins[axis];
  const double max = axes.maxs[axis];
  const bool cell = axes.cells[axis];
  double spacing = axes.spacings[axis];
  if (!std::isfinite(spacing) && std::isfinite(max - min)) {
    spacing = (max - min) / (static_cast<double>(axes.sizes[axis]) - (cell ? 0 : 1));
  }
  if (std::isnan(spacing)) spacing = 1;
  const double start = std::isfinite(min) ? min + (cell ? 0.5 * spacing : 0) : 0;
  return {spacing, start};
}

/// A step for an axis that a line or a picture does not have: across the others, of length 1.
glm::dvec3 missing_step(const std::vector<glm::dvec3>& steps) {
  if (steps.size() == 2) return glm::normalize(glm::cross(steps[0], steps[1]));
  const glm::dvec3 a = glm::abs(steps[0]);
  const glm::dvec3 least = a.x <= a.y && a.x <= a.z ? glm::dvec3(1, 0, 0)
                           : a.y <= a.z             ? glm::dvec3(0, 1, 0)
                                                    : glm::dvec3(0, 0, 1);
  return glm::normalize(glm::cross(steps[0], least));
}

}  // namespace

Result<NrrdSpace> parse_space(const NrrdFields& fields) {
  static const std::map<std::string, WorldFrame, std::less<>> kSpaces = {
      {"right-anterior-superior", WorldFrame::kRas}, {"ras", WorldFrame::kRas},
      {"left-anterior-superior", WorldFrame::kLas},  {"las", WorldFrame::kLas},
      {"left-posterior-superior", WorldFrame::kLps}, {"lps", WorldFrame::kLps},
      {"scanner-xyz", WorldFrame::kUnstated},        {"3d-right-handed", WorldFrame::kUnstated},
      {"3d-left-handed", WorldFrame::kUnstated},
  };
  NrrdSpace space;
  if (const std::string_view name = field(fields, "space"); !name.empty()) {
    const auto known = kSpaces.find(to_lower(name));
    if (known == kSpaces.end()) {
      return fail(ErrorKind::kUnsupported, "NRRD: not a space of three dimensions: " + scan::printable(name));
    }
    space.frame = known->second;
  }
  if (const std::string_view text = field(fields, "spacedimension"); !text.empty()) {
    const auto dimension = scan::parse_number<uint64_t>(text);
    if (!dimension || *dimension < 1) return bad_header(kNrrd, "not a dimension", text);
    if (*dimension > 3) return fail(ErrorKind::kUnsupported, "NRRD: a space of more than three dimensions");
    space.dimension = *dimension;
  }
  return space;
}

Result<NrrdAxes> parse_axes(const NrrdFields& fields, const NrrdSpace& space) {
  NrrdAxes axes;
  const auto dimension = scan::parse_number<uint64_t>(field(fields, "dimension"));
  auto sizes = counts_of(field(fields, "sizes"));
  if (!dimension) return bad_header(kNrrd, "not a dimension", field(fields, "dimension"));
  if (!sizes || sizes->size() != *dimension || sizes->empty()) {
    return bad_header(kNrrd, "not a size for each axis", field(fields, "sizes"));
  }
  axes.sizes = std::move(*sizes);
  if (Status status = parse_kinds(fields, axes); !status) return fail(status);
  for (const auto& [name, into] :
       {std::pair{"spacings", &axes.spacings}, {"axismins", &axes.mins}, {"axismaxs", &axes.maxs}}) {
    Result<std::vector<double>> numbers = per_axis(fields, name, axes.sizes.size());
    if (!numbers) return fail(numbers);
    *into = std::move(*numbers);
  }
  if (!fields.contains("spacedirections")) return axes;
  auto directions = parse_vectors(field(fields, "spacedirections"), space.dimension);
  if (!directions) return fail(directions);
  if (directions->size() != axes.sizes.size()) {
    return bad_header(kNrrd, "not a direction for each axis", field(fields, "spacedirections"));
  }
  axes.directions = std::move(*directions);
  return axes;
}

Result<std::vector<size_t>> domain_of(const NrrdAxes& axes, StoredGrid& grid) {
  std::vector<size_t> domain;
  for (size_t axis = 0; axis < axes.sizes.size(); ++axis) {
    const bool extends = is_domain(axes, axis) && (domain.size() < 3 || axes.sizes[axis] != 1);
    if (extends && domain.size() == 3) {
      return fail(ErrorKind::kUnsupported, "NRRD: more than three axes of space, " + std::to_string(axes.sizes[axis]) +
                                               " samples along another; only scalars and tensors are read");
    }
    if (extends) {
      domain.push_back(axis);
      continue;
    }
    const Result<SampleKind> kind = kind_of_axis(axes, axis);
    if (!kind) return fail(kind);
    if (*kind == SampleKind::kScalar) continue;
    const bool last = axis + 1 == axes.sizes.size();
    if (grid.header.kind != SampleKind::kScalar || (axis > 0 && !last)) {
      return fail(ErrorKind::kUnsupported,
                  "NRRD: the axis of components lies between axes of space; it must be the first or the last");
    }
    grid.header.kind = *kind;
    grid.planar = axis > 0;
  }
  return domain;
}

Status place(const NrrdFields& fields, const NrrdSpace& space, const NrrdAxes& axes, const std::vector<size_t>& domain,
             GridHeader& header) {
  std::vector<glm::dvec3> steps;
  glm::dvec3 origin(0);
  for (size_t i = 0; i < domain.size(); ++i) {
    header.size[i] = axes.sizes[domain[i]];
    const auto [spacing, start] = spacing_and_start(axes, domain[i]);
    glm::dvec3 step(0);
    step[static_cast<int>(i)] = spacing;
    origin[static_cast<int>(i)] = start;
    steps.push_back(axes.directions.empty() ? step : axes.directions[domain[i]].value_or(glm::dvec3(0)));
  }
  while (steps.size() < 3) {
    header.size[steps.size()] = 1;
    steps.push_back(missing_step(steps));
  }
  if (!axes.directions.empty()) origin = glm::dvec3(0);
  if (const std::string_view text = field(fields, "spaceorigin"); !text.empty()) {
    const auto vectors = parse_vectors(text, space.dimension);
    if (!vectors) return fail(vectors);
    if (vectors->size() != 1 || !vectors->front()) return bad_header(kNrrd, "not an origin", text);
    origin = *vectors->front();
  }
  header.index_to_world = glm::dmat4x3(steps[0], steps[1], steps[2], origin);
  return {};
}

Status parse_measurement_frame(const NrrdFields& fields, GridHeader& header) {
  const std::string_view text = field(fields, "measurementframe");
  if (text.empty()) return {};
  const auto vectors = parse_vectors(text, 3);
  if (!vectors) return fail(vectors);
  if (vectors->size() != 3 || !(*vectors)[0] || !(*vectors)[1] || !(*vectors)[2]) {
    return bad_header(kNrrd, "not a measurement frame", text);
  }
  header.measurement_frame = glm::dmat3(*(*vectors)[0], *(*vectors)[1], *(*vectors)[2]);
  return {};
}

}  // namespace surfcast::grid
