#include "scan/sampled_rows.h"

#include <algorithm>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include <oneapi/tbb/parallel_for.h>

#include "scan/sliced_rows.h"

namespace surfcast::scan {
namespace {

/// Rows kept of a piece, for every row that its share of the sample will need: pieces may differ in size that much.
constexpr uint64_t kSpare = 3;

struct PieceSample {
  uint64_t of_rows = 0;
  uint64_t announced = 0;
  size_t rows = 0;
  std::vector<std::byte> records;  ///< `rows` packed ones
};

/// A number from 0 to `below` - 1 that looks random (the finaliser of SplitMix64, Steele et al. 2014).
uint64_t scatter(uint64_t place, uint64_t below) {
  uint64_t x = place + 0x9e3779b97f4a7c15;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9;
  x = (x ^ (x >> 27)) * 0x94d049bb133111eb;
  return (x ^ (x >> 31)) % below;
}

/// Chooses `kept` of `rows` rows: one of each of as many runs of nearly equal length.
template <typename Use>
void for_each_chosen(uint64_t rows, uint64_t kept, uint64_t seed, const Use& use) {
  for (uint64_t run = 0; run < kept; ++run) {
    const uint64_t first = run * rows / kept;
    const uint64_t end = (run + 1) * rows / kept;
    use(static_cast<size_t>(first + scatter(seed ^ (run << 20), end - first)));
  }
}

size_t record_size(const std::vector<ColumnInfo>& columns) {
  size_t bytes = 0;
  for (const ColumnInfo& column : columns) bytes += size_of(column.type);
  return bytes;
}

PieceSample take_sample(const PointTable& table, uint64_t kept, uint64_t seed, size_t bytes) {
  PieceSample sample{table.rows, table.announced, static_cast<size_t>(std::min<uint64_t>(kept, table.rows)), {}};
  sample.records.resize(sample.rows * bytes);
  std::byte* to = sample.records.data();
  for_each_chosen(table.rows, sample.rows, seed, [&](size_t row) {
    for (const Column& column : table.columns) {
      const size_t size = size_of(column.type);
      std::memcpy(to, column.first + row * column.stride, size);
      to += size;
    }
  });
  return sample;
}

/// A table of packed records with these columns.
PointTable packed_table(std::vector<std::byte> records, const std::vector<ColumnInfo>& columns,
                        const std::vector<bool>& swapped, size_t bytes) {
  PointTable table;
  table.rows = records.size() / bytes;
  table.records = std::move(records);
  const std::byte* first = table.records.data();
  for (size_t i = 0; i < columns.size(); ++i) {
    table.columns.push_back({columns[i].type, first, bytes, swapped[i]});
    first += size_of(columns[i].type);
  }
  return table;
}

/// Of the rows kept of each piece, those of its share.
std::vector<std::byte> join(const std::vector<PieceSample>& pieces, uint64_t wanted, uint64_t of_rows, size_t bytes) {
  std::vector<std::byte> records;
  records.reserve(static_cast<size_t>(std::min(wanted + pieces.size(), of_rows)) * bytes);
  for (const PieceSample& piece : pieces) {
    const uint64_t share = wanted >= of_rows ? piece.of_rows : (piece.of_rows * wanted + of_rows - 1) / of_rows;
    for_each_chosen(piece.rows, std::min<uint64_t>(share, piece.rows), records.size(), [&](size_t row) {
      const std::byte* from = piece.records.data() + row * bytes;
      records.insert(records.end(), from, from + bytes);
    });
  }
  return records;
}

struct AllPieces {
  std::vector<PieceSample> pieces;
  std::vector<bool> swapped;  ///< of each column
};

Result<AllPieces> read_pieces(const RowSource& rows, uint64_t kept, size_t bytes) {
  std::vector<Result<PieceSample>> samples(rows.pieces());
  AllPieces all;
  oneapi::tbb::parallel_for(size_t{0}, rows.pieces(), [&](size_t i) {
    const Result<PointTable> table = rows.read(i);
    samples[i] = table ? Result<PieceSample>(take_sample(*table, kept, i << 40, bytes)) : fail(table);
    if (i > 0 || !table) return;
    for (const Column& column : table->columns) all.swapped.push_back(column.swapped);
  });
  for (Result<PieceSample>& sample : samples) {
    if (!sample) return fail(sample);
    all.pieces.push_back(std::move(*sample));
  }
  return all;
}

}  // namespace

Result<RowSample> sample_rows(const RowSource& rows, uint64_t wanted) {
  const size_t bytes = record_size(rows.columns());
  if (bytes == 0 || wanted == 0) return fail(ErrorKind::kInvalidInput, "has no points");
  const uint64_t kept = kSpare * (wanted / rows.pieces() + 1);
  Result<AllPieces> all = read_pieces(rows, kept, bytes);
  if (!all) return fail(all);
  uint64_t of_rows = 0;
  uint64_t announced = rows.traits().announced;
  for (const PieceSample& piece : all->pieces) {
    of_rows += piece.of_rows;
    announced += piece.announced;
  }
  if (Status whole = check_announced(of_rows, announced); !whole) return fail(whole);
  RowTraits traits = rows.traits();
  traits.announced = 0;
  traits.sampled = true;
  std::vector<std::byte> records = join(all->pieces, wanted, of_rows, bytes);
  PointTable table = packed_table(std::move(records), rows.columns(), all->swapped, bytes);
  return RowSample{std::make_unique<SlicedRows>(traits, rows.columns(), std::move(table)), of_rows};
}

}  // namespace surfcast::scan
