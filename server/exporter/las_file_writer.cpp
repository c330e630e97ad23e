#include "exporter/las_file_writer.h"

#include <algorithm>
#include <utility>

#include <oneapi/tbb/info.h>
#include <oneapi/tbb/parallel_for.h>

#include "exporter/las_bytes.h"
#include "laz/chunk_encoders.h"
#include "scan/scalar_type.h"

namespace surfcast::exporter {
namespace {

using Bytes = std::vector<std::byte>;
using scan::load;

// Offsets in the public header block: LAS 1.4 specification, table 3.
constexpr size_t kVersionMinor = 25;
constexpr size_t kDataOffset = 96;
constexpr size_t kRecordCount = 100;
constexpr size_t kPointFormat = 104;
constexpr size_t kRecordLength = 105;
constexpr size_t kLegacyCount = 107;
constexpr size_t kLegacyReturns = 111;
constexpr size_t kScale = 131;
constexpr size_t kOffset = 155;
constexpr size_t kBounds = 179;  // largest and smallest x, then y, then z
constexpr size_t kExtendedOffset = 235;
constexpr size_t kExtendedCount = 243;
constexpr size_t kCount = 247;
constexpr size_t kReturns = 255;
constexpr uint8_t kCompressedBit = 0x80;

laz::Coding coding_of(const LasHead& head) {
  return {*laz::record_layout(head.point_format, head.record_length), head.chunk_size};
}

/// From version 1.4 on.
bool has_wide_counts(const Bytes& header) {
  return load<uint8_t>(&header[kVersionMinor]) >= 4;
}

/// Return number of a record; 0 counts as none.
size_t return_of(const std::byte* record, int point_format) {
  return std::to_integer<size_t>(record[14]) & (point_format < 6 ? 7U : 15U);
}

}  // namespace

LasFileWriter::LasFileWriter(AtomicFile file, std::filesystem::path target, LasHead head)
    : file_(std::move(file)), target_(std::move(target)), head_(std::move(head)) {
  low_.fill(INT32_MAX);
  high_.fill(INT32_MIN);
}

Result<LasFileWriter> LasFileWriter::create(const std::filesystem::path& target, LasHead head) {
  Result<AtomicFile> file = AtomicFile::create(target);
  if (!file) return fail(std::move(file.error()));
  LasFileWriter writer(std::move(*file), target, std::move(head));
  if (Status status = writer.write_head(); !status) return fail(std::move(status.error()));
  return writer;
}

Status LasFileWriter::write_head() {
  if (head_.compressed) {
    head_.records.push_back(las_record("laszip encoded", 22204, laz::encode_laszip_record(coding_of(head_))));
  }
  Bytes bytes = head_.header;
  for (const Bytes& record : head_.records) add_bytes(bytes, record);
  data_offset_ = bytes.size();
  if (head_.compressed) add(bytes, int64_t{-1});  // where the chunk table will be
  return file_.append(bytes);
}

Status LasFileWriter::append(std::span<const std::byte> records) {
  count(records);
  if (!head_.compressed) return file_.append(records);
  add_bytes(waiting_, records);
  // As many chunks at once as there are threads.
  const size_t chunk = head_.chunk_size * head_.record_length;
  const size_t at_once = chunk * static_cast<size_t>(oneapi::tbb::info::default_concurrency());
  if (waiting_.size() < at_once) return {};
  const size_t whole = waiting_.size() / chunk * chunk;
  if (Status status = append_chunks(std::span(waiting_).first(whole)); !status) return status;
  waiting_.erase(waiting_.begin(), waiting_.begin() + static_cast<ptrdiff_t>(whole));
  return {};
}

Status LasFileWriter::append_chunks(std::span<const std::byte> records) {
  const laz::Coding coding = coding_of(head_);
  const size_t size = head_.chunk_size * head_.record_length;
  std::vector<Bytes> coded((records.size() + size - 1) / size);
  const auto records_of = [&](size_t i) {
    return records.subspan(i * size, std::min(size, records.size() - i * size));
  };
  oneapi::tbb::parallel_for(size_t{0}, coded.size(),
                            [&](size_t i) { coded[i] = laz::encode_chunk(coding, records_of(i)); });
  for (size_t i = 0; i < coded.size(); ++i) {
    chunks_.push_back({records_of(i).size() / head_.record_length, coded[i].size()});
    if (Status status = file_.append(coded[i]); !status) return status;
  }
  return {};
}

void LasFileWriter::count(std::span<const std::byte> records) {
  points_ += records.size() / head_.record_length;
  for (size_t at = 0; at < records.size(); at += head_.record_length) {
    const std::byte* record = &records[at];
    for (size_t axis = 0; axis < 3; ++axis) {
      const auto number = load<int32_t>(record + 4 * axis);
      low_[axis] = std::min(low_[axis], number);
      high_[axis] = std::max(high_[axis], number);
    }
    const size_t number = return_of(record, head_.point_format);
    if (number > 0) ++returns_[number - 1];
  }
}

/// Point formats from 6 on have no counts of 32 bits, and versions before 1.4 no others.
void LasFileWriter::fill_in_header() {
  Bytes& header = head_.header;
  put(header, kDataOffset, static_cast<uint32_t>(data_offset_));
  put(header, kRecordCount, static_cast<uint32_t>(head_.records.size()));
  put(header, kPointFormat, static_cast<uint8_t>(head_.point_format | (head_.compressed ? kCompressedBit : 0)));
  put(header, kRecordLength, static_cast<uint16_t>(head_.record_length));
  const bool legacy = head_.point_format < 6 && points_ <= UINT32_MAX;
  put(header, kLegacyCount, legacy ? static_cast<uint32_t>(points_) : 0U);
  for (size_t i = 0; i < 5; ++i) put(header, kLegacyReturns + 4 * i, legacy ? static_cast<uint32_t>(returns_[i]) : 0U);
  for (size_t axis = 0; axis < 3; ++axis) {
    const auto scale = load<double>(&header[kScale + 8 * axis]), offset = load<double>(&header[kOffset + 8 * axis]);
    const double a = low_[axis] * scale + offset, b = high_[axis] * scale + offset;
    put(header, kBounds + 16 * axis, std::max(a, b));  // a scale may be negative
    put(header, kBounds + 16 * axis + 8, std::min(a, b));
  }
  if (!has_wide_counts(header)) return;
  put(header, kCount, points_);
  for (size_t i = 0; i < returns_.size(); ++i) put(header, kReturns + 8 * i, returns_[i]);
}

Status LasFileWriter::write_chunk_table() {
  if (Status status = append_chunks(waiting_); !status) return status;
  waiting_.clear();
  std::vector<laz::ChunkSize> sizes;
  sizes.reserve(chunks_.size());
  for (const Chunk& chunk : chunks_) sizes.push_back({chunk.points, chunk.bytes});
  Bytes place;
  add(place, static_cast<int64_t>(file_.position()));
  if (Status status = file_.overwrite(data_offset_, place); !status) return status;
  return file_.append(laz::encode_chunk_table(coding_of(head_), sizes));
}

Status LasFileWriter::write_extended() {
  if (!has_wide_counts(head_.header)) return {};
  put(head_.header, kExtendedOffset, head_.extended.empty() ? uint64_t{0} : uint64_t{file_.position()});
  put(head_.header, kExtendedCount, static_cast<uint32_t>(head_.extended.size()));
  for (const Bytes& record : head_.extended) {
    if (Status status = file_.append(record); !status) return status;
  }
  return {};
}

Result<uint64_t> LasFileWriter::finish() {
  if (!has_wide_counts(head_.header) && points_ > UINT32_MAX) {
    return fail(ErrorKind::kLimit, target_.string() + ": more points than LAS before version 1.4 can hold");
  }
  Status status = head_.compressed ? write_chunk_table() : Status();
  if (status) status = write_extended();
  if (!status) return fail(std::move(status.error()));
  fill_in_header();
  status = file_.overwrite(0, head_.header);
  const uint64_t bytes = file_.position();
  if (status) status = file_.commit();
  if (!status) return fail(std::move(status.error()));
  return bytes;
}

}  // namespace surfcast::exporter
