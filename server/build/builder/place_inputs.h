#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/result.h"
#include "crs/transformation.h"
#include "geometry/box.h"
#include "model/georeference.h"
#include "scan/scan_schema.h"

namespace surfcast::builder {

/// What is known of coordinate systems beside what inputs state. A system is WKT or a code like EPSG:25832.
struct SystemOptions {
  std::string assigned;           ///< of the inputs that state none, or none that is known; empty: none
  bool overrides_stated = false;  ///< of all inputs
  std::string target;             ///< that all inputs are brought into; empty: that of the first input that has one
};

/// An input that was brought into another system.
struct TransformedInput {
  std::string input;  ///< file name without its folders
  std::string from;   ///< names of systems
  std::string to;
  std::string operation;           ///< as PROJ calls it
  std::optional<double> accuracy;  ///< metres; none: unknown
};

/// How all inputs of a model come into one metric system.
struct Placement {
  std::vector<std::shared_ptr<const crs::Transformation>> moves;  ///< for each input; null: it stays where it is
  model::Georeference georeference;                               ///< of the model; not known if no input has a system
  std::vector<TransformedInput> transformed;
  std::vector<std::string> notes;  ///< one line each, for people
};

/// `bounds`: of the positions of each input, as it states them. Systems of inputs that are unknown or plainly wrong are
/// noted and ignored. Errors: a system of the options that is unknown; a transformation that PROJ cannot do.
Result<Placement> place_inputs(std::span<const scan::ScanSchema> inputs, std::span<const geometry::Box> bounds,
                               const SystemOptions& options);

}  // namespace surfcast::builder
