#include "builder/divide_points.h"

#include <algorithm>
#include <map>
#include <memory>
#include <string>
#include <utility>

#include <oneapi/tbb/info.h>

#include "builder/cell_counts.h"
#include "builder/ordered_work.h"

namespace surfcast::builder {
namespace {

size_t reading_threads() {
  return static_cast<size_t>(oneapi::tbb::info::default_concurrency());
}

std::vector<uint64_t> codes_of(const scan::ScanPoints& points, const geometry::RootCube& root) {
  std::vector<uint64_t> codes(points.size());
  std::transform(points.positions.begin(), points.positions.end(), codes.begin(),
                 [&root](const glm::dvec3& p) { return geometry::morton_code(root, p); });
  return codes;
}

std::vector<PartRows> sort_out(const scan::ScanPoints& points, const PartFinder& finder, const geometry::RootCube& root,
                               std::optional<uint32_t> only) {
  std::map<std::pair<uint32_t, bool>, std::vector<uint32_t>> rows;
  const std::vector<uint64_t> codes = codes_of(points, root);
  for (uint32_t i = 0; i < points.size(); ++i) {
    bool own = true;
    finder.for_each_part(points.positions[i], codes[i], [&](uint32_t part) {
      if (!only || part == *only) rows[{part, own}].push_back(i);
      own = false;
    });
  }
  std::vector<PartRows> parts;
  parts.reserve(rows.size());
  for (auto& [key, list] : rows) parts.push_back({key.first, key.second, std::move(list)});
  return parts;
}

Result<std::vector<CountedCell>> count_points(const BuildInputs& inputs, const geometry::RootCube& root, uint64_t limit,
                                              StageClock& clock, const SeePiece& see) {
  const CodePass pass = [&](const std::function<void(std::span<const uint64_t>)>& count) {
    clock.begin("counting", inputs.pieces());
    return work_in_order(inputs.pieces(), reading_threads(), [&](size_t i) -> Result<std::function<Status()>> {
      estimation::SurfelReport report;
      const Result<InputPiece> piece = inputs.read(i, report);
      if (!piece) return fail(piece);
      count(codes_of(piece->points, root));
      if (see) see(i, *piece, report);
      clock.step();
      return [] { return Status(); };
    });
  };
  return count_cells(pass, limit);
}

/// Cells so small that parts of them can be equal.
uint64_t points_of_cell(uint64_t points, size_t parts) {
  return std::max<uint64_t>(1, points / parts);
}

}  // namespace

Result<std::vector<Part>> divide_points(const BuildInputs& inputs, const geometry::RootCube& root,
                                        const Division& division, StageClock& clock, const SeePiece& see) {
  const uint64_t points = inputs.size();
  if (division.parts ? *division.parts == 1 : division.memory.fits_whole(points)) {
    const CountedCell all{0, 0, points};
    return plan_parts({&all, 1}, points);
  }
  const uint64_t limit = division.parts ? points_of_cell(points, *division.parts) : division.memory.part_points;
  const Result<std::vector<CountedCell>> cells = count_points(inputs, root, limit, clock, see);
  if (!cells) return fail(cells);
  if (!division.parts) return plan_parts(*cells, limit);
  std::vector<Part> parts = plan_part_count(*cells, *division.parts);
  if (parts.size() == *division.parts) return parts;
  return fail(ErrorKind::kLimit, "--parts " + std::to_string(*division.parts) +
                                     ": the points lie in so few places that they cannot be divided into more than " +
                                     std::to_string(parts.size()) + " parts");
}

Status distribute_points(const BuildInputs& inputs, std::span<const size_t> pieces, const PartFinder& finder,
                         const geometry::RootCube& root, std::optional<uint32_t> only, PartStore& store,
                         StageClock& clock, estimation::SurfelReport& report) {
  clock.begin("sorting points", pieces.size());
  return work_in_order(pieces.size(), reading_threads() + 1, [&](size_t i) -> Result<std::function<Status()>> {
    estimation::SurfelReport own;
    const Result<InputPiece> piece = inputs.read(pieces[i], own);
    if (!piece) return fail(piece);
    const std::vector<PartRows> parts = sort_out(piece->points, finder, root, only);
    return [&, own, packed = std::make_shared<PackedPiece>(pack_piece(*piece, parts))] {
      report.add(own);
      clock.step();
      return store.add(*packed);
    };
  });
}

}  // namespace surfcast::builder
