#include "cmd/input_flags.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <spdlog/fmt/fmt.h>

#include "model/volume.h"
#include "protocol/parse.h"
#include "protocol/request_flags.h"
#include "scattered/field_lattice.h"

namespace surfcast::cmd {
namespace {

constexpr double kAnywhere = std::numeric_limits<double>::infinity();

/// Numbers between commas; none if one of them is no number.
std::vector<double> numbers_of(std::string_view text) {
  const auto commas = static_cast<size_t>(std::count(text.begin(), text.end(), ','));
  return protocol::parse_doubles(text, commas + 1).value_or(std::vector<double>());
}

/// Two corners, with or without heights.
geometry::Box box_of(const std::string& text) {
  const std::vector<double> numbers = numbers_of(text);
  geometry::Box box;
  if (numbers.size() == 4) {
    box.include(glm::dvec3(numbers[0], numbers[1], -kAnywhere));
    box.include(glm::dvec3(numbers[2], numbers[3], kAnywhere));
  } else if (numbers.size() == 6) {
    box.include(glm::dvec3(numbers[0], numbers[1], numbers[2]));
    box.include(glm::dvec3(numbers[3], numbers[4], numbers[5]));
  } else {
    throw CLI::ValidationError("--bounds", "needs 4 or 6 numbers");
  }
  return box;
}

/// Its width and the corners of its line; behind an @ its heights.
geometry::Corridor corridor_of(const std::string& text) {
  const size_t at = text.find('@');
  const std::vector<double> numbers = numbers_of(text.substr(0, at));
  if (numbers.size() < 5 || numbers.size() % 2 == 0 || numbers[0] < 0)
    throw CLI::ValidationError("--corridor", "needs a width and at least two corners");
  geometry::Corridor corridor;
  corridor.half_width = numbers[0] / 2;
  for (size_t i = 1; i < numbers.size(); i += 2) corridor.line.emplace_back(numbers[i], numbers[i + 1]);
  if (at == std::string::npos) return corridor;
  const std::vector<double> heights = numbers_of(text.substr(at + 1));
  if (heights.size() != 2) throw CLI::ValidationError("--corridor", "needs two heights behind the @");
  corridor.low = std::min(heights[0], heights[1]);
  corridor.high = std::max(heights[0], heights[1]);
  return corridor;
}

void add_zone_flags(CLI::App& command, geometry::Zone& zone) {
  command
      .add_option_function<std::vector<std::string>>(
          "--bounds",
          [&zone](const std::vector<std::string>& texts) {
            for (const std::string& text : texts) zone.boxes.push_back(box_of(text));
          },
          "Read only points in a box, two opposite corners in the coordinates of the scan: X,Y,X,Y or X,Y,Z,X,Y,Z. "
          "May be given several times: points in any of the boxes")
      ->type_name("X,Y[,Z],X,Y[,Z]")
      ->allow_extra_args(false);
  command
      .add_option_function<std::vector<std::string>>(
          "--corridor",
          [&zone](const std::vector<std::string>& texts) {
            for (const std::string& text : texts) zone.corridors.push_back(corridor_of(text));
          },
          "Read only points along a line, seen from above, in a corridor of this width: WIDTH,X,Y,X,Y and further "
          "corners, with @LOW,HIGH between these heights only. May be given several times")
      ->type_name("WIDTH,X,Y,X,Y...")
      ->allow_extra_args(false);
}

}  // namespace

void add_selection_flags(CLI::App& command, scan::Selection& selection) {
  add_zone_flags(command, selection.zone);
  command
      .add_option_function<std::vector<int>>(
          "--classes",
          [&selection](const std::vector<int>& classes) { selection.classes.assign(classes.begin(), classes.end()); },
          "Read only points of these classes, like 2,6")
      ->delimiter(',')
      ->check(CLI::Range(0, 255));
  command.add_option("--every", selection.every, "Read only every N-th point of each piece in which a scan is read")
      ->check(CLI::PositiveNumber);
}

namespace {

constexpr std::array<std::pair<std::string_view, estimation::RadiusPolicy>, 3> kPolicies = {
    {{"auto", estimation::RadiusPolicy::kAuto},
     {"keep", estimation::RadiusPolicy::kKeep},
     {"estimate", estimation::RadiusPolicy::kEstimate}}};

estimation::RadiusPolicy radius_policy(const std::string& name) {
  return std::ranges::find(kPolicies, name, [](const auto& entry) { return entry.first; })->second;
}

}  // namespace

CLI::Option* add_radius_flag(CLI::App& command, estimation::RadiusPolicy& policy) {
  return command
      .add_option_function<std::string>(
          "--radii", [&policy](const std::string& name) { policy = radius_policy(name); },
          "Radii that scans state: auto (scaled to the kernel where they follow the sampling, else estimated), keep or "
          "estimate (default auto)")
      ->check(CLI::IsMember({"auto", "keep", "estimate"}));
}

std::string name_of(estimation::RadiusPolicy policy) {
  return std::string(std::ranges::find(kPolicies, policy, [](const auto& entry) { return entry.second; })->first);
}

namespace {

mesh::FacePolicy face_policy(const std::string& name) {
  if (name == "use") return mesh::FacePolicy::kUse;
  return name == "ignore" ? mesh::FacePolicy::kIgnore : mesh::FacePolicy::kAuto;
}

std::string name_of_faces(mesh::FacePolicy policy) {
  if (policy == mesh::FacePolicy::kUse) return "use";
  return policy == mesh::FacePolicy::kIgnore ? "ignore" : "auto";
}

}  // namespace

void add_mesh_flags(CLI::App& command, builder::MeshOptions& options) {
  command
      .add_option("--mesh-spacing", options.spacing,
                  "Distance of the surfels of a mesh, in its units (default: one surfel a texel, and 1/1500 of the "
                  "diagonal where there is no texture)")
      ->envname(protocol::environment_name("mesh-spacing"))
      ->check(CLI::PositiveNumber);
  command
      .add_option("--mesh-surfels", options.most_surfels,
                  "Most surfels of a mesh: distances are doubled until there are no more (default: 200000000)")
      ->envname(protocol::environment_name("mesh-surfels"))
      ->check(CLI::PositiveNumber);
  command
      .add_option_function<std::string>(
          "--faces", [&options](const std::string& name) { options.faces = face_policy(name); },
          "Faces of PLY files: use them (surfels of a mesh), ignore them (its vertices are a scan), or auto: use them "
          "where there are colours or texture coordinates (default auto)")
      ->envname(protocol::environment_name("faces"))
      ->check(CLI::IsMember({"auto", "use", "ignore"}));
}

std::vector<std::string> arguments_of(const builder::MeshOptions& options) {
  const builder::MeshOptions usual;
  std::vector<std::string> arguments;
  if (options.spacing) arguments.insert(arguments.end(), {"--mesh-spacing", fmt::format("{}", *options.spacing)});
  if (options.most_surfels != usual.most_surfels) {
    arguments.insert(arguments.end(), {"--mesh-surfels", std::to_string(options.most_surfels)});
  }
  if (options.faces != usual.faces) arguments.insert(arguments.end(), {"--faces", name_of_faces(options.faces)});
  return arguments;
}

namespace {

bool is_code(double number) {
  return number >= 0 && number <= 255 && std::trunc(number) == number;
}

}  // namespace

Result<isosurface::IsoSurface> parse_iso_surface(std::string_view text) {
  const std::vector<double> numbers = numbers_of(text);
  const bool counted = numbers.size() == 1 || numbers.size() == 4 || numbers.size() == 5;
  const bool colored = numbers.size() > 1;
  if (!counted || (colored && !std::all_of(numbers.begin() + 1, numbers.begin() + 4, is_code))) {
    return fail(ErrorKind::kInvalidInput,
                "not VALUE or VALUE,R,G,B with a colour of integers from 0 to 255: " + std::string(text));
  }
  if (numbers.size() == 5 && numbers[4] != 1) {
    return fail(ErrorKind::kUnsupported, "surfaces of an opacity other than 1 are not supported: " + std::string(text));
  }
  isosurface::IsoSurface surface{numbers[0]};
  if (colored) surface.color = glm::u8vec3(numbers[1], numbers[2], numbers[3]);
  return surface;
}

CLI::Option* add_iso_flag(CLI::App& command, std::vector<isosurface::IsoSurface>& surfaces) {
  const auto append = [&surfaces](const std::vector<std::string>& texts) {
    for (const std::string& text : texts) {
      const Result<isosurface::IsoSurface> surface = parse_iso_surface(text);
      if (!surface) throw CLI::ValidationError("--iso", surface.error().message);
      surfaces.push_back(*surface);
    }
  };
  return command
      .add_option_function<std::vector<std::string>>(
          "--iso", append,
          "Make of a volume the surface where it has this value: VALUE or VALUE,R,G,B (0 to 255; default light grey). "
          "May be given several times")
      ->type_name("VALUE[,R,G,B]")
      ->allow_extra_args(false);
}

namespace {

std::optional<double> positive(std::string_view text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !(value > 0) || !std::isfinite(value)) {
    return std::nullopt;
  }
  return value;
}

std::optional<simplify::ErrorBound> parse_bound(std::string_view text) {
  const size_t comma = text.find(',');
  const std::optional<double> degrees = positive(text.substr(0, comma));
  if (!degrees || *degrees > 45) return std::nullopt;
  if (comma == std::string_view::npos) return simplify::ErrorBound{*degrees, std::nullopt};
  const std::optional<double> height = positive(text.substr(comma + 1));
  if (!height) return std::nullopt;
  return simplify::ErrorBound{*degrees, height};
}

}  // namespace

void add_simplify_flag(CLI::App& command, std::optional<simplify::ErrorBound>& bound) {
  command
      .add_option_function<std::string>(
          "--simplify", [&bound](const std::string& text) { bound = parse_bound(text); },
          "Replace the points of smooth surfaces by fewer surfels with curvature. DEGREES[,HEIGHT]: nine in ten "
          "normals "
          "are within DEGREES, all points within HEIGHT of the surface, in units of the scan (default: twice the angle "
          "times the distance)")
      ->type_name("DEGREES[,HEIGHT]")
      ->check([](const std::string& text) {
        return parse_bound(text) ? std::string() : "not degrees up to 45 and a height: " + text;
      });
}

namespace {

scattered::FieldOptions& made(std::optional<scattered::FieldOptions>& field) {
  if (!field) field.emplace();
  return *field;
}

std::string fault_of_sizes(const std::string& text) {
  const Result<scattered::KernelSizes> sizes = scattered::parse_kernel_sizes(text);
  return sizes ? std::string() : sizes.error().message;
}

void add_kernel_flags(CLI::App& command, CLI::Option* value, std::optional<scattered::FieldOptions>& field) {
  command
      .add_option_function<std::string>(
          "--kernel", [&field](const std::string& text) { made(field).sizes = *scattered::parse_kernel_sizes(text); },
          "What states the size of a sample's kernel: radius=, smoothing= or sigma= with a column or a length, "
          "covariance=PREFIX or spacing (default: as the columns are named, else spacing)")
      ->type_name("MEANING=COLUMN")
      ->check(fault_of_sizes)
      ->needs(value);
  command
      .add_option_function<std::string>(
          "--kernel-weight", [&field](const std::string& column) { made(field).weight = column; },
          "Column by which the kernels of samples are multiplied")
      ->type_name("COLUMN")
      ->needs(value);
}

void add_lattice_flags(CLI::App& command, CLI::Option* value, std::optional<scattered::FieldOptions>& field) {
  command
      .add_option_function<uint32_t>(
          "--resolution", [&field](uint32_t samples) { made(field).resolution = samples; },
          "Samples of the volume along its longest axis (default: as the kernels need, at most 134 million in all)")
      ->check(CLI::Range(scattered::kMinResolution, model::kMaxAxisSamples))
      ->needs(value);
  command
      .add_option_function<double>(
          "--outside", [&field](double background) { made(field).background = background; },
          "Value of an average where there are no samples (default: the lowest value)")
      ->needs(value);
  command
      .add_option_function<double>(
          "--least-weight", [&field](double weight) { made(field).least_weight = weight; },
          "Sum of kernels below which the background counts in an average (default: 0.1)")
      ->check(CLI::PositiveNumber)
      ->needs(value);
}

}  // namespace

void add_field_flags(CLI::App& command, std::optional<scattered::FieldOptions>& field) {
  static const std::map<std::string, scattered::Combination> kCombinations{
      {"sum", scattered::Combination::kSum},
      {"average", scattered::Combination::kAverage},
      {"density", scattered::Combination::kDensity}};
  CLI::Option* value = command
                           .add_option_function<std::string>(
                               "--value", [&field](const std::string& column) { made(field).value = column; },
                               "Points with this column are samples of a field, and become a volume")
                           ->type_name("COLUMN");
  command
      .add_option_function<std::string>(
          "--combine", [&field](const std::string& name) { made(field).combination = kCombinations.at(name); },
          "How kernels make the field: sum (of value times kernel, which is 1 at its centre; the default), average "
          "(divided by the sum of the kernels), density (the integral of a kernel is 1: the values are masses)")
      ->check(CLI::IsMember({"sum", "average", "density"}))
      ->needs(value);
  add_kernel_flags(command, value, field);
  add_lattice_flags(command, value, field);
}

}  // namespace surfcast::cmd
