#include "scan/laz_rows.h"

#include <algorithm>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "base/memory_source.h"
#include "laz/laz_file.h"
#include "scan/copc_index.h"
#include "scan/las_reader.h"

namespace surfcast::scan {
namespace {

/// Records of a chunk that follow each other.
struct Slice {
  size_t chunk = 0;
  uint64_t first = 0;  ///< in the chunk
  uint64_t count = 0;
};

/// Records of a slice. A file may have one chunk for all of its points, and records of 64 KiB that repeat themselves,
/// so that a chunk would take any memory as a piece.
uint64_t slice_rows(const laz::LazFile& file) {
  constexpr uint64_t kMaxBytes = uint64_t{64} << 20;
  return std::min(kPieceRows, kMaxBytes / file.record_length());
}

std::vector<Slice> slices_of(const laz::LazFile& file) {
  const std::span<const laz::Chunk> chunks = file.chunks();
  const uint64_t rows = slice_rows(file);
  std::vector<Slice> slices;
  for (size_t chunk = 0; chunk < chunks.size(); ++chunk) {
    for (uint64_t first = 0; first < chunks[chunk].count; first += rows) {
      slices.push_back({chunk, first, std::min(rows, chunks[chunk].count - first)});
    }
  }
  return slices;
}

/// Reads slices. A chunk can only be decoded from its start on. So readers that have stopped between two slices of a
/// chunk are kept, and a slice takes the one that has come closest to it. Thread-safe.
class SliceReader {
 public:
  explicit SliceReader(const laz::LazFile& file) : file_(file) {}

  Result<std::vector<std::byte>> read(const Slice& slice) {
    Result<Stopped> stopped = reader_before(slice);
    if (!stopped) return fail(stopped);
    if (Status status = skip(*stopped, slice.first); !status) return fail(status);
    std::vector<std::byte> records(slice.count * file_.record_length());
    if (Status status = stopped->reader.read(records); !status) return fail(status);
    stopped->next = slice.first + slice.count;
    if (stopped->next < file_.chunks()[slice.chunk].count) keep(std::move(*stopped));
    return records;
  }

 private:
  struct Stopped {
    size_t chunk = 0;
    uint64_t next = 0;  ///< record of the chunk that the reader reads next
    laz::LazChunkReader reader;
  };

  /// More than threads that read at a time. A reader takes some hundred kilobytes.
  static constexpr size_t kKept = 64;

  Result<Stopped> reader_before(const Slice& slice) {
    if (std::optional<Stopped> kept = take(slice)) return std::move(*kept);
    return file_.read_chunk(file_.chunks()[slice.chunk]).map([&](laz::LazChunkReader reader) {
      return Stopped{slice.chunk, 0, std::move(reader)};
    });
  }

  std::optional<Stopped> take(const Slice& slice) {
    const std::lock_guard lock(mutex_);
    auto best = kept_.end();
    for (auto place = kept_.begin(); place != kept_.end(); ++place) {
      if (place->chunk != slice.chunk || place->next > slice.first) continue;
      if (best == kept_.end() || place->next > best->next) best = place;
    }
    if (best == kept_.end()) return std::nullopt;
    Stopped taken = std::move(*best);
    kept_.erase(best);
    return taken;
  }

  void keep(Stopped stopped) {
    const std::lock_guard lock(mutex_);
    if (kept_.size() >= kKept) kept_.erase(kept_.begin());
    kept_.push_back(std::move(stopped));
  }

  [[nodiscard]] Status skip(Stopped& stopped, uint64_t to) const {
    if (stopped.next == to) return {};
    const uint64_t rows = slice_rows(file_);
    std::vector<std::byte> records(rows * file_.record_length());
    for (; stopped.next < to; stopped.next += rows) {  // slices end at multiples of it
      if (Status status = stopped.reader.read(records); !status) return status;
    }
    return {};
  }

  const laz::LazFile& file_;
  std::mutex mutex_;
  std::vector<Stopped> kept_;  ///< in the order in which they stopped
};

class LazRows : public RowSource {
 public:
  LazRows(laz::LazFile file, LasHeader header)
      : file_(std::move(file)),
        header_(std::move(header)),
        traits_(las_traits(header_)),
        columns_(las_columns(header_)),
        slices_(slices_of(file_)) {}

  [[nodiscard]] const RowTraits& traits() const override { return traits_; }
  [[nodiscard]] const std::vector<ColumnInfo>& columns() const override { return columns_; }
  [[nodiscard]] size_t pieces() const override { return slices_.size(); }
  [[nodiscard]] Result<PointTable> read(size_t piece) const override {
    const Slice& slice = slices_[piece];
    Result<std::vector<std::byte>> records = reader_.read(slice);
    if (!records) return fail(records);
    PointTable table = las_table(records->data(), slice.count, header_);
    table.records = std::move(*records);
    return table;
  }

 private:
  laz::LazFile file_;
  LasHeader header_;
  RowTraits traits_;
  std::vector<ColumnInfo> columns_;
  std::vector<Slice> slices_;
  mutable SliceReader reader_{file_};
};

/// The chunks of nodes with points, in file order.
std::vector<laz::Chunk> chunks_of(const CopcNodes& nodes) {
  std::vector<laz::Chunk> chunks;
  for (const CopcNode& node : nodes.nodes) {
    if (node.points > 0) chunks.push_back({0, node.points, node.chunk.offset, node.chunk.size});
  }
  std::ranges::sort(chunks, {}, &laz::Chunk::offset);
  return chunks;
}

/// All chunks of the file, or of COPC those of the nodes that meet the bounds.
Result<laz::LazFile> open_file(std::span<const std::byte> bytes, const laz::LazPoints& points, const LasHeader& header,
                               const Selection& selection) {
  if (selection.zone.everywhere() || header.copc_record.empty()) {
    return laz::LazFile::open(bytes, points, header.laszip_record);
  }
  const Result<CopcInfo> info = read_copc_info(header.copc_record);
  if (!info) return fail(info);
  return read_copc_nodes(MemorySource(bytes), *info, selection.zone).and_then([&](const CopcNodes& nodes) {
    return laz::LazFile::open_chunks(bytes, points, header.laszip_record, chunks_of(nodes));
  });
}

}  // namespace

Result<std::unique_ptr<RowSource>> laz_rows(std::span<const std::byte> bytes, LasHeader header,
                                            const Selection& selection) {
  if (header.laszip_record.empty()) {
    return fail(ErrorKind::kInvalidInput, "LAZ compressed, but without a LASzip record");
  }
  const laz::LazPoints points = {header.point_format, header.record_length, header.count, header.data_offset};
  Result<laz::LazFile> file = open_file(bytes, points, header, selection);
  if (!file) return fail(file);
  return std::make_unique<LazRows>(std::move(*file), std::move(header));
}

}  // namespace surfcast::scan
