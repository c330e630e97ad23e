#include "exporter/record_spool.h"

#include <algorithm>
#include <utility>

namespace surfcast::exporter {

RecordSpool::RecordSpool(std::filesystem::path target, size_t record_bytes, uint64_t memory)
    : target_(std::move(target)), record_bytes_(record_bytes), memory_(memory) {}

Status RecordSpool::append(std::span<const std::byte> records) {
  if (!waiting_.empty() && waiting_.size() + records.size() > memory_) {
    if (Status status = write_waiting(); !status) return status;
  }
  waiting_.insert(waiting_.end(), records.begin(), records.end());
  return {};
}

Status RecordSpool::write_waiting() {
  if (!file_) {
    Result<SpoolFile> created = SpoolFile::create(target_);
    if (!created) return fail(created);
    file_ = std::move(*created);
  }
  const Result<uint64_t> written = file_->append(waiting_);
  if (!written) return fail(written);
  waiting_.clear();
  return {};
}

Status RecordSpool::for_each_batch(bool release, const std::function<Status(std::span<const std::byte>)>& use) {
  const size_t batch = std::max<size_t>(memory_ / 4 / record_bytes_, 1) * record_bytes_;
  std::vector<std::byte> records;
  for (uint64_t at = 0; file_ && at < file_->size(); at += records.size()) {
    records.resize(std::min<uint64_t>(batch, file_->size() - at));
    if (Status status = file_->read(at, records); !status) return status;
    if (release) file_->release(at, records.size());
    if (Status status = use(records); !status) return status;
  }
  return waiting_.empty() ? Status() : use(waiting_);
}

}  // namespace surfcast::exporter
