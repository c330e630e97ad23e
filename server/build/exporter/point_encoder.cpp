#include "exporter/point_encoder.h"

#include <algorithm>

#include "exporter/point_encoders.h"

namespace surfcast::exporter {

std::optional<PointFormat> point_format_of(std::string_view name) {
  const auto* known = std::ranges::find(kPointFormats, name, &std::pair<std::string_view, PointFormat>::first);
  if (known == kPointFormats.end()) return std::nullopt;
  return known->second;
}

WantedFacts facts_for(PointFormat format) {
  const bool las = format == PointFormat::kLas || format == PointFormat::kLaz;
  return las ? WantedFacts::kAll : WantedFacts::kNumber;
}

Result<std::unique_ptr<PointEncoder>> make_point_encoder(PointFormat format, scan::ScanSchema schema,
                                                         const PointFacts& facts, const EncoderOptions& options) {
  switch (format) {
    case PointFormat::kPly:
      return make_ply_encoder(std::move(schema), facts.count);
    case PointFormat::kCsv:
      return make_csv_encoder(std::move(schema));
    case PointFormat::kNpy:
      return make_npy_encoder(std::move(schema), facts.count);
    case PointFormat::kLas:
    case PointFormat::kLaz:
      break;
  }
  schema.grid = facts.grid;
  return make_las_encoder(schema, facts, options, format == PointFormat::kLaz);
}

}  // namespace surfcast::exporter
