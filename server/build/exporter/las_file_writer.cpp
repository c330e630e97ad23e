#include "exporter/las_file_writer.h"

#include <algorithm>
#include <utility>

#include <oneapi/tbb/info.h>
#include <oneapi/tbb/parallel_for.h>

#include "exporter/las_bytes.h"
#include "exporter/las_coding.h"

namespace surfcast::exporter {
namespace {

using Bytes = std::vector<std::byte>;

// Offsets in the public header block: LAS 1.4 specification, table 3.
constexpr size_t kExtendedOffset = 235;
constexpr size_t kExtendedCount = 243;

}  // namespace

LasFileWriter::LasFileWriter(AtomicFile file, std::filesystem::path target, LasHead head)
    : file_(std::move(file)), target_(std::move(target)), head_(std::move(head)) {}

Result<LasFileWriter> LasFileWriter::create(const std::filesystem::path& target, LasHead head) {
  Result<AtomicFile> file = AtomicFile::create(target);
  if (!file) return fail(file);
  LasFileWriter writer(std::move(*file), target, std::move(head));
  if (Status status = writer.write_head(); !status) return fail(status);
  return writer;
}

Status LasFileWriter::write_head() {
  add_laszip_record(head_);
  const Bytes bytes = bytes_before_points(head_);
  data_offset_ = bytes.size() - (head_.compressed ? sizeof(int64_t) : 0);
  return file_.append(bytes);
}

Status LasFileWriter::append(std::span<const std::byte> records) {
  counts_.add(records, head_);
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
  if (!head_.has_wide_counts()) return {};
  put(head_.header, kExtendedOffset, head_.extended.empty() ? uint64_t{0} : uint64_t{file_.position()});
  put(head_.header, kExtendedCount, static_cast<uint32_t>(head_.extended.size()));
  for (const Bytes& record : head_.extended) {
    if (Status status = file_.append(record); !status) return status;
  }
  return {};
}

Result<uint64_t> LasFileWriter::finish() {
  if (!head_.has_wide_counts() && counts_.points > UINT32_MAX) {
    return fail(ErrorKind::kLimit, target_.string() + ": more points than LAS before version 1.4 can hold");
  }
  Status status = head_.compressed ? write_chunk_table() : Status();
  if (status) status = write_extended();
  if (!status) return fail(status);
  fill_in_header(head_, counts_, data_offset_);
  status = file_.overwrite(0, head_.header);
  const uint64_t bytes = file_.position();
  if (status) status = file_.commit();
  if (!status) return fail(status);
  return bytes;
}

}  // namespace surfcast::exporter
