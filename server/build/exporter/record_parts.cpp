#include "exporter/record_parts.h"

#include <algorithm>
#include <array>
#include <map>
#include <numeric>
#include <utility>

#include <oneapi/tbb/parallel_for.h>

namespace surfcast::exporter {
namespace {

/// Depths of the cells in which points are counted, the finer ones where coarser ones have too many. They bound the
/// memory for counts: at most 4096 cells in one.
constexpr std::array<int, 4> kCountDepths = {6, 10, 14, 18};

}  // namespace

struct RecordParts::CellCount {
  uint64_t first = 0;  ///< the least code of the cell
  uint64_t count = 0;
  uint64_t low = UINT64_MAX;  ///< of the codes of the points
  uint64_t high = 0;

  void add(uint64_t code) {
    ++count;
    low = std::min(low, code);
    high = std::max(high, code);
  }
  void add(const CellCount& more) {
    count += more.count;
    low = std::min(low, more.low);
    high = std::max(high, more.high);
  }
};

bool RecordParts::is_divided(const CellCount& cell) const {
  return cell.count > limits_.points && cell.low != cell.high;
}

/// Of all points or of those with some codes.
Result<std::vector<RecordParts::CellCount>> RecordParts::count_cells(
    RecordSpool& spool, int depth, const std::function<bool(uint64_t)>& wanted) const {
  std::map<uint64_t, CellCount> cells;
  const Status counted = spool.for_each_batch(false, [&](std::span<const std::byte> records) -> Status {
    CellCount* cell = nullptr;
    for (const uint64_t code : places_.codes(records)) {
      if (!wanted(code)) continue;
      const uint64_t first = code / codes_of_cell(depth) * codes_of_cell(depth);
      if (cell == nullptr || cell->first != first) cell = &cells[first];
      cell->first = first;
      cell->add(code);
    }
    return {};
  });
  if (!counted) return fail(counted);
  std::vector<CellCount> all;
  all.reserve(cells.size());
  for (const auto& [first, cell] : cells) all.push_back(cell);
  return all;
}

Result<std::vector<RecordParts::CellCount>> RecordParts::count_points(RecordSpool& spool) const {
  Result<std::vector<CellCount>> cells = count_cells(spool, kCountDepths.front(), [](uint64_t) { return true; });
  for (size_t i = 1; cells && i < kCountDepths.size() && kCountDepths[i - 1] < limits_.depth; ++i) {
    Status status = refine(spool, *cells, kCountDepths[i - 1], kCountDepths[i]);
    if (!status) return fail(status);
  }
  return cells;
}

/// Replaces cells that have too many points by smaller ones.
Status RecordParts::refine(RecordSpool& spool, std::vector<CellCount>& cells, int depth, int finer_depth) const {
  std::vector<uint64_t> full;
  for (const CellCount& cell : cells) {
    if (is_divided(cell)) full.push_back(cell.first / codes_of_cell(depth));
  }
  if (full.empty()) return {};
  const auto is_full = [&](uint64_t code) {
    return std::binary_search(full.begin(), full.end(), code / codes_of_cell(depth));
  };
  const Result<std::vector<CellCount>> finer = count_cells(spool, finer_depth, is_full);
  if (!finer) return fail(finer);
  std::erase_if(cells, [&](const CellCount& cell) { return is_full(cell.first); });
  cells.insert(cells.end(), finer->begin(), finer->end());
  std::ranges::sort(cells, {}, &CellCount::first);
  return {};
}

void RecordParts::choose(std::span<const CellCount> cells, const ldc::OctreeKey& key, uint64_t first) {
  if (cells.empty()) return;
  CellCount all;
  for (const CellCount& cell : cells) all.add(cell);
  if (!is_divided(all) || key.depth == limits_.depth) {
    parts_.push_back({key, first, all.count});
    return;
  }
  const uint64_t step = codes_of_cell(key.depth + 1);
  for (uint32_t octant = 0; octant < 8; ++octant) {
    const uint64_t begin = first + octant * step;
    const auto from = std::ranges::lower_bound(cells, begin, {}, &CellCount::first);
    const auto to = std::ranges::lower_bound(cells, begin + step, {}, &CellCount::first);
    choose({from, to}, key.child(octant), begin);
  }
}

Status RecordParts::divide(RecordSpool& spool, const std::filesystem::path& target) {
  if (spool.is_resident()) {
    resident_ = spool.take_resident();
    parts_ = {{{}, 0, resident_.size() / places_.record_bytes()}};
    return {};
  }
  const Result<std::vector<CellCount>> cells = count_points(spool);
  if (!cells) return fail(cells);
  choose(*cells, {}, 0);
  extents_.resize(parts_.size());
  Result<SpoolFile> file = SpoolFile::create(target);
  if (!file) return fail(file);
  file_ = std::move(*file);
  return spool.for_each_batch(true, [this](std::span<const std::byte> records) { return distribute(records); });
}

size_t RecordParts::part_of(uint64_t code) const {
  return static_cast<size_t>(std::ranges::upper_bound(parts_, code, {}, &RecordPart::first) - parts_.begin()) - 1;
}

/// Appends the records of a batch to the file, those of a part together.
Status RecordParts::distribute(std::span<const std::byte> records) {
  const size_t size = places_.record_bytes();
  const std::vector<uint64_t> codes = places_.codes(records);
  std::vector<size_t> parts(codes.size()), places(parts_.size());
  oneapi::tbb::parallel_for(size_t{0}, codes.size(), [&](size_t i) { parts[i] = part_of(codes[i]); });
  for (const size_t part : parts) places[part] += size;
  uint64_t offset = file_->size();
  for (size_t part = 0; part < places.size(); offset += places[part++]) {
    if (places[part] != 0) extents_[part].push_back({offset, places[part]});
  }
  std::exclusive_scan(places.begin(), places.end(), places.begin(), size_t{0});
  std::vector<std::byte> sorted(records.size());
  for (size_t i = 0; i < parts.size(); ++i) {
    std::copy_n(&records[i * size], size, &sorted[places[parts[i]]]);
    places[parts[i]] += size;
  }
  const Result<uint64_t> written = file_->append(sorted);
  return written ? Status() : fail(written);
}

Result<std::vector<std::byte>> RecordParts::take(size_t part) {
  if (!file_) return std::move(resident_);
  std::vector<std::byte> records(parts_[part].count * places_.record_bytes());
  size_t at = 0;
  for (const Extent& extent : extents_[part]) {
    Status status = file_->read(extent.offset, std::span(records).subspan(at, extent.size));
    if (!status) return fail(status);
    file_->release(extent.offset, extent.size);
    at += extent.size;
  }
  return records;
}

}  // namespace surfcast::exporter
