#include "builder/append_checks.h"

#include <algorithm>
#include <vector>

#include "builder/input_files.h"
#include "ldc/coarse_scalars.h"
#include "model/block_decoder.h"
#include "scan/merge_schemas.h"
#include "surfel/curvature.h"

namespace surfcast::builder {
namespace {

/// What a scan has that the model lacks; empty: nothing.
std::string surplus_of(const scan::ScanSchema& input, const scan::ScanSchema& model) {
  if (input.color_bits > model.color_bits) return model.color_bits == 0 ? "colours" : "colours of 16 bits";
  for (const scan::ScalarField& field : input.scalars) {
    const auto known = std::ranges::find(model.scalars, field.name, &scan::ScalarField::name);
    if (known == model.scalars.end()) return "the attribute " + field.name;
    const scan::ScanSchema both = scan::merge_schemas(std::vector{model, input});
    const auto merged = std::ranges::find(both.scalars, field.name, &scan::ScalarField::name);
    if (merged->type != known->type) return "larger numbers of the attribute " + field.name;
  }
  return {};
}

}  // namespace

tl::unexpected<Error> refuse_append(const std::filesystem::path& subject, const std::string& why) {
  return fail(ErrorKind::kUnsupported, subject.string() + ": " + why);
}

Status check_grown_model(const model::ModelFile& model) {
  const model::ModelInfo& info = model.info();
  const bool surfels = info.kinds.size() == 1 && info.kinds.front().kind == model::kSurfelKind;
  if (!surfels) return refuse_append(model.path(), "cannot be added to, because it holds more than surfels");
  if (info.even) return refuse_append(model.path(), "cannot be added to, because it is made of meshes");
  for (const model::ScalarColumn& scalar : model.scalars()) {
    if (surfel::is_curvature_column(scalar.name)) {
      return refuse_append(model.path(), "cannot be added to, because it is simplified");
    }
    if (scalar.coarse != ldc::is_coarse_scalar(scalar.name)) {
      return refuse_append(model.path(), "cannot be added to, because an older program made it; build it anew");
    }
  }
  return {};
}

Status check_added_scans(std::span<const std::filesystem::path> inputs) {
  for (const std::filesystem::path& input : inputs) {
    if (kind_of_input(input) != InputKind::kScan) {
      return refuse_append(input, "only scans can be added to a model, and this is none");
    }
  }
  return {};
}

Status check_added_columns(const BuildInputs& inputs, std::span<const std::filesystem::path> paths,
                           const scan::ScanSchema& model) {
  for (size_t i = 0; i < paths.size(); ++i) {
    const std::string surplus = surplus_of(inputs.schemas()[i], model);
    if (!surplus.empty()) return refuse_append(paths[i], "has " + surplus + ", which " + model.name + " lacks");
  }
  return {};
}

}  // namespace surfcast::builder
