#include "service/source_positions.h"

#include <cmath>
#include <utility>

#include "crs/transformation.h"
#include "exporter/source_system.h"

namespace surfcast::service {

struct SourcePositions::Way {
  std::unique_ptr<const crs::Transformation> transformation;  ///< null: none
};

SourcePositions::SourcePositions() = default;
SourcePositions::~SourcePositions() = default;

std::shared_ptr<const SourcePositions::Way> SourcePositions::way_of(const model::ModelFile& model) {
  const std::lock_guard lock(mutex_);
  if (auto found = ways_.find(model.id())) return found;
  auto made = std::make_shared<Way>();
  if (const Result<model::Georeference> georeference = model.georeference()) {
    auto way = exporter::way_to_source(*georeference, model.info().bounds);
    if (way) made->transformation = std::move(*way);
  }
  ways_.put(model.id(), made, 1);
  return made;
}

std::optional<glm::dvec3> SourcePositions::find(const model::ModelFile& model, const glm::dvec3& position) {
  const std::shared_ptr<const Way> way = way_of(model);
  if (!way->transformation) return std::nullopt;
  glm::dvec3 source = position;
  way->transformation->apply({&source, 1});
  if (!std::isfinite(source.x + source.y + source.z)) return std::nullopt;
  return source;
}

}  // namespace surfcast::service
