#include "stream/mapped_stream.h"

#include <algorithm>
#include <cstring>
#include <utility>

#include "base/contract.h"

namespace surfcast::stream {
namespace {

/// Bytes read between two releases of pages: a release costs one system call, and neighbouring pages are read again.
constexpr uint64_t kReleaseInterval = uint64_t{16} << 20;

}  // namespace

Result<FilePtr> open_shared(const std::filesystem::path& path) {
  Result<MappedFile> file = MappedFile::open(path);
  if (!file) return fail(file);
  return std::make_shared<const MappedFile>(std::move(*file));
}

MappedStream::MappedStream(FilePtr file, uint64_t offset, uint64_t size) : file_(std::move(file)) {
  SURFCAST_EXPECTS(offset <= file_->bytes().size());
  rest_ = file_->bytes().subspan(offset);
  rest_ = rest_.first(std::min<uint64_t>(size, rest_.size()));
}

Result<size_t> MappedStream::read(std::span<std::byte> out) {
  const size_t size = std::min(out.size(), rest_.size());
  if (size > 0) std::memcpy(out.data(), rest_.data(), size);
  rest_ = rest_.subspan(size);
  unreleased_ += size;
  if (unreleased_ >= kReleaseInterval) {
    file_->release_pages();
    unreleased_ = 0;
  }
  return size;
}

Status MappedStream::skip(uint64_t count) {
  if (count > rest_.size()) return fail(ErrorKind::kInvalidInput, "truncated: the data ends too early");
  rest_ = rest_.subspan(count);
  return {};
}

}  // namespace surfcast::stream
