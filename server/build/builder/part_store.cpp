#include "builder/part_store.h"

#include <algorithm>
#include <utility>

#include "builder/cloud_columns.h"

namespace surfcast::builder {
namespace {

uint64_t bytes_of_row(const scan::ScanSchema& schema) {
  surfel::SurfelCloud one = empty_cloud(schema, 1);
  uint64_t bytes = 0;
  for (const std::span<std::byte> column : column_memory(one, 0, 1)) bytes += column.size();
  return bytes;
}

/// Calls `use` with every array of the findings, until one call fails.
template <typename Findings, typename Use>
Status for_each_finding(Findings& findings, const Use& use) {
  Status status = use(findings.order);
  if (status) status = use(findings.normals);
  if (status) status = use(findings.radii);
  if (status) status = use(findings.trees);
  if (status) status = use(findings.kinds);
  if (status) status = use(findings.kept);
  return status;
}

}  // namespace

PackedPiece pack_piece(const InputPiece& piece, std::span<const PartRows> parts) {
  PackedPiece packed;
  packed.source = piece.source;
  for (const PartRows& part : parts) {
    packed.runs.push_back({part.part, part.own, packed.bytes.size(), part.rows.size()});
    append_columns(piece.points, part.rows, packed.bytes);
  }
  return packed;
}

PartStore::PartStore(SpoolFile file, const scan::ScanSchema& schema, std::vector<InputName> inputs, size_t parts)
    : file_(std::move(file)),
      schema_(schema),
      inputs_(std::move(inputs)),
      row_bytes_(bytes_of_row(schema)),
      parts_(parts) {}

Status PartStore::add(const PackedPiece& piece) {
  const Result<uint64_t> offset = file_.append(piece.bytes);
  if (!offset) return fail(offset);
  for (const PackedPiece::Run& run : piece.runs) {
    parts_[run.part].extents.push_back({piece.source, run.own, *offset + run.offset, run.rows});
  }
  return {};
}

uint64_t PartStore::points(size_t part) const {
  uint64_t points = 0;
  for (const Extent& extent : parts_[part].extents) points += extent.rows;
  return points;
}

Result<PartPoints> PartStore::load(size_t part) const {
  std::vector<Extent> extents = parts_[part].extents;
  const auto order = [](const Extent& e) { return std::pair(e.own ? 0 : 1, e.source); };
  std::stable_sort(extents.begin(), extents.end(),
                   [&order](const Extent& a, const Extent& b) { return order(a) < order(b); });
  PartPoints points;
  points.cloud = empty_cloud(schema_, this->points(part));
  size_t first = 0;
  for (const Extent& extent : extents) {
    uint64_t offset = extent.offset;
    for (const std::span<std::byte> column : column_memory(points.cloud, first, extent.rows)) {
      if (Status status = file_.read(offset, column); !status) return fail(status);
      offset += column.size();
    }
    std::vector<surfel::SourceRange>& sources = points.cloud.sources;
    if (points.inputs.empty() || points.inputs.back() != extent.source || (!extent.own && points.own == first)) {
      sources.push_back({inputs_[extent.source].name, first, 0, inputs_[extent.source].grid});
      points.inputs.push_back(extent.source);
    }
    sources.back().count += extent.rows;
    first += extent.rows;
    if (extent.own) points.own = first;
  }
  return points;
}

Status PartStore::keep_findings(size_t part, const PartFindings& findings) {
  parts_[part].findings = file_.size();
  return for_each_finding(findings, [this](const auto& values) -> Status {
    const Result<uint64_t> offset = file_.append(std::as_bytes(std::span(values)));
    return offset ? Status() : fail(offset);
  });
}

Result<PartFindings> PartStore::load_findings(size_t part) const {
  const uint64_t points = this->points(part);
  uint64_t offset = parts_[part].findings;
  PartFindings findings;
  Status status = for_each_finding(findings, [&](auto& values) {
    values.resize(points);
    const std::span<std::byte> memory = std::as_writable_bytes(std::span(values));
    Status read = file_.read(offset, memory);
    offset += memory.size();
    return read;
  });
  if (!status) return fail(status);
  return findings;
}

void PartStore::release(size_t part) const {
  for (const Extent& extent : parts_[part].extents) file_.release(extent.offset, extent.rows * row_bytes_);
}

}  // namespace surfcast::builder
