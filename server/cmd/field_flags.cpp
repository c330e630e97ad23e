#include "cmd/field_flags.h"

#include <cstdint>
#include <functional>
#include <map>
#include <string>

#include "model/volume.h"
#include "scattered/field_lattice.h"

namespace surfcast::cmd {
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
