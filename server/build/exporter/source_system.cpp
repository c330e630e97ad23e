#include "exporter/source_system.h"

#include <memory>
#include <utility>

namespace surfcast::exporter {

Result<std::unique_ptr<const crs::Transformation>> way_to_source(const model::Georeference& georeference,
                                                                 const geometry::Box& bounds) {
  if (!georeference.source.known()) return nullptr;
  const Result<crs::CoordinateSystem> from = crs::read_system(georeference.system.wkt);
  if (!from) return fail(from);
  const Result<crs::CoordinateSystem> to = crs::read_system(georeference.source.wkt);
  if (!to) return fail(to);
  Result<crs::Transformation> way = crs::Transformation::between(*from, *to, bounds);
  if (!way) return fail(way);
  return std::make_unique<const crs::Transformation>(std::move(*way));
}

}  // namespace surfcast::exporter
