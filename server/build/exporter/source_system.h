#pragma once

#include <memory>

#include "base/result.h"
#include "crs/transformation.h"
#include "geometry/box.h"
#include "model/georeference.h"

namespace surfcast::exporter {

/// From the system of a model's positions to that of its source; null if they are one, or unknown. `bounds`: of the
/// model. Fails where PROJ is not installed or knows no way.
Result<std::unique_ptr<const crs::Transformation>> way_to_source(const model::Georeference& georeference,
                                                                 const geometry::Box& bounds);

}  // namespace surfcast::exporter
