#include "grid/vtk_block_stream.h"

#include <algorithm>
#include <utility>

#include "scan/scalar_type.h"
#include "stream/inflate_stream.h"

namespace surfcast::grid {
namespace {

using stream::StreamPtr;

/// Reads header integers of either width.
class Integers {
 public:
  Integers(stream::ByteStream& source, const VtkBlockCoding& coding) : source_(source), coding_(coding) {}
  [[nodiscard]] size_t width() const { return coding_.wide ? sizeof(uint64_t) : sizeof(uint32_t); }
  Result<uint64_t> next() {
    std::array<std::byte, sizeof(uint64_t)> raw{};
    if (Status status = read_exactly(source_, std::span(raw).first(width())); !status) return fail(status);
    return coding_.wide ? scan::load<uint64_t>(raw.data(), coding_.swapped)
                        : scan::load<uint32_t>(raw.data(), coding_.swapped);
  }

 private:
  stream::ByteStream& source_;
  const VtkBlockCoding& coding_;
};

/// The block's own decoder reads through a stream that this object keeps.
class BorrowedStream final : public stream::ByteStream {
 public:
  explicit BorrowedStream(stream::ByteStream& source) : source_(source) {}
  Result<size_t> read(std::span<std::byte> out) override { return source_.read(out); }
  [[nodiscard]] uint64_t at_most() const override { return source_.at_most(); }

 private:
  stream::ByteStream& source_;
};

}  // namespace

VtkBlockStream::~VtkBlockStream() = default;

Result<StreamPtr> VtkBlockStream::open(StreamPtr source, const VtkBlockCoding& coding) {
  std::unique_ptr<VtkBlockStream> stream(new VtkBlockStream(std::move(source)));
  if (Status status = stream->read_header(coding); !status) return fail(status);
  return StreamPtr(std::move(stream));
}

Status VtkBlockStream::read_header(const VtkBlockCoding& coding) {
  Integers integers(*source_, coding);
  const Result<uint64_t> first = integers.next();
  if (!first) return fail(first);
  if (!coding.compressed) {
    left_ = unpacked_ = *first;
    return {};
  }
  const Result<uint64_t> size = integers.next();
  const Result<uint64_t> last = size ? integers.next() : size;
  if (!last) return fail(last);
  if (*first > source_->at_most() / integers.width()) {
    return fail(ErrorKind::kInvalidInput,
                "truncated: states " + std::to_string(*first) + " blocks, which it cannot hold");
  }
  for (uint64_t i = 0; i < *first; ++i) {
    const Result<uint64_t> packed = integers.next();
    if (!packed) return fail(packed);
    packed_sizes_.push_back(*packed);
  }
  block_size_ = *size;
  last_size_ = *last == 0 ? *size : *last;
  unpacked_ = packed_sizes_.empty() ? 0 : stream::saturating(packed_sizes_.size() - 1, block_size_, last_size_);
  return {};
}

uint64_t VtkBlockStream::at_most() const {
  // As for all of the source's bytes in one block; see InflateStream.
  return packed_sizes_.empty() ? std::min(unpacked_, source_->at_most())
                               : std::min(unpacked_, stream::saturating(source_->at_most(), 1032, uint64_t{1} << 16));
}

Status VtkBlockStream::begin_block() {
  packed_ = std::make_unique<stream::LimitedStream>(*source_, packed_sizes_[next_]);
  block_ = std::make_unique<stream::InflateStream>(std::make_unique<BorrowedStream>(*packed_));
  left_ = ++next_ == packed_sizes_.size() ? last_size_ : block_size_;
  return {};
}

/// Reads to the end of the block's data, which checks its sum.
Status VtkBlockStream::end_block() {
  std::byte more{};
  const Result<size_t> read = block_->read({&more, 1});
  if (!read) return fail(read);
  if (*read != 0) return fail(ErrorKind::kInvalidInput, "damaged: a block is larger than stated");
  const uint64_t rest = packed_->left();
  block_.reset();
  return packed_->skip(rest);
}

Result<size_t> VtkBlockStream::read(std::span<std::byte> out) {
  size_t done = 0;
  while (done < out.size() && (left_ > 0 || next_ < packed_sizes_.size())) {
    if (left_ == 0) {
      if (Status status = begin_block(); !status) return fail(status);
      if (left_ == 0) return fail(ErrorKind::kInvalidInput, "damaged: a block of no bytes");
    }
    const std::span part = out.subspan(done, std::min<uint64_t>(out.size() - done, left_));
    if (Status status = read_exactly(block_ ? *block_ : *source_, part); !status) return fail(status);
    done += part.size();
    left_ -= part.size();
    if (left_ > 0 || !block_) continue;
    if (Status status = end_block(); !status) return fail(status);
  }
  return done;
}

}  // namespace surfcast::grid
