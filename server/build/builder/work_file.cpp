#include "builder/work_file.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <utility>

#include <zstd.h>

#include "base/contract.h"
#include "base/hash.h"

namespace surfcast::builder {
namespace {

constexpr uint64_t kWorkFileVersion = 2;
/// Bytes that are packed together, with one checksum: enough for the speed of the disk, few enough to be checked with
/// little memory.
constexpr uint64_t kPieceBytes = uint64_t{1} << 20;
/// Of zstd. Surfels take 69 bytes each without it, 36 at this level, for which a part takes 8 % more processor time,
/// and 32 at level 3, for 11 % more.
constexpr int kLevel = 1;
constexpr size_t kDigestDigits = 32;

/// The last bytes of a work file. All members are at multiples of their size.
struct Trailer {
  std::array<char, 8> magic{'S', 'U', 'R', 'F', 'W', 'O', 'R', 'K'};
  uint64_t version = kWorkFileVersion;
  std::array<char, kDigestDigits> plan{};
  uint64_t step = 0;
  uint64_t part = 0;
  uint64_t sections = 0;
  uint64_t table = 0;     ///< numbers in the table before the trailer
  uint64_t checksum = 0;  ///< of the table and of the members above
};

std::span<const std::byte> bytes_of(const Trailer& trailer) {
  return std::as_bytes(std::span(&trailer, 1)).first(sizeof(Trailer) - sizeof(uint64_t));
}

uint64_t checksum_of(const Trailer& trailer, std::span<const uint64_t> table) {
  return hash_of(bytes_of(trailer), hash_of(std::as_bytes(table)));
}

Trailer trailer_of(const WorkOwner& owner) {
  SURFCAST_EXPECTS(owner.plan.size() == kDigestDigits);
  Trailer trailer;
  std::copy(owner.plan.begin(), owner.plan.end(), trailer.plan.begin());
  trailer.step = static_cast<uint64_t>(owner.step);
  trailer.part = owner.part;
  return trailer;
}

uint64_t pieces_in(uint64_t bytes) {
  return bytes / kPieceBytes + (bytes % kPieceBytes != 0 ? 1 : 0);
}

/// Packs a piece into `buffer`. Returns the packed bytes, or the piece itself where packing saves nothing.
std::span<const std::byte> pack(std::span<const std::byte> piece, std::vector<std::byte>& buffer) {
  buffer.resize(ZSTD_compressBound(piece.size()));
  const size_t packed = ZSTD_compress(buffer.data(), buffer.size(), piece.data(), piece.size(), kLevel);
  if (ZSTD_isError(packed) != 0 || packed >= piece.size()) return piece;
  return std::span(buffer).first(packed);
}

/// False unless `packed` is exactly such a piece.
bool unpack(std::span<const std::byte> packed, std::span<std::byte> piece) {
  return ZSTD_decompress(piece.data(), piece.size(), packed.data(), packed.size()) == piece.size();
}

}  // namespace

Result<WorkFileWriter> WorkFileWriter::create(const std::filesystem::path& target, WorkOwner owner) {
  Result<AtomicFile> file = AtomicFile::create(target);
  if (!file) return fail(file);
  return WorkFileWriter(std::move(*file), std::move(owner));
}

Status WorkFileWriter::add(std::span<const std::byte> section) {
  ++sections_;
  table_.push_back(section.size());
  std::vector<std::byte> buffer;
  while (!section.empty()) {
    const std::span<const std::byte> piece = section.first(std::min<size_t>(section.size(), kPieceBytes));
    const std::span<const std::byte> stored = pack(piece, buffer);
    table_.push_back(stored.size());
    table_.push_back(hash_of(stored));
    if (Status status = file_.append(stored); !status) return status;
    section = section.subspan(piece.size());
  }
  return {};
}

Status WorkFileWriter::finish() {
  Trailer trailer = trailer_of(owner_);
  trailer.sections = sections_;
  trailer.table = table_.size();
  trailer.checksum = checksum_of(trailer, table_);
  Status status = file_.append(std::as_bytes(std::span(table_)));
  if (status) status = file_.append(std::as_bytes(std::span(&trailer, 1)));
  return status ? file_.commit() : status;
}

Result<WorkFile> WorkFile::open(const std::filesystem::path& path, const WorkOwner& owner) {
  Result<PositionedFile> file = PositionedFile::open(path);
  if (!file) return fail(file);
  WorkFile work(path, std::move(*file));
  if (Status status = work.read_table(owner); !status) return fail(status);
  return work;
}

Error WorkFile::damaged() const {
  return {ErrorKind::kInvalidInput, path_.string() + ": is damaged"};
}

Status WorkFile::read_table(const WorkOwner& owner) {
  Trailer trailer;
  if (file_.size() < sizeof(trailer)) return fail(damaged());
  const uint64_t end = file_.size() - sizeof(trailer);
  if (!file_.read(end, std::as_writable_bytes(std::span(&trailer, 1)))) return fail(damaged());
  if (trailer.magic != Trailer().magic || trailer.table > end / sizeof(uint64_t)) return fail(damaged());
  std::vector<uint64_t> table(trailer.table);
  const uint64_t start = end - table.size() * sizeof(uint64_t);
  if (!file_.read(start, std::as_writable_bytes(std::span(table)))) return fail(damaged());
  if (trailer.checksum != checksum_of(trailer, table)) return fail(damaged());
  const Trailer own = trailer_of(owner);
  if (trailer.version != own.version || trailer.plan != own.plan || trailer.step != own.step ||
      trailer.part != own.part) {
    return fail(ErrorKind::kReplaced, path_.string() + ": belongs to another plan");
  }
  if (!take_sections(table, start) || sections_.size() != trailer.sections) return fail(damaged());
  return {};
}

/// False unless the sections fill the file up to `end`.
bool WorkFile::take_sections(std::span<const uint64_t> table, uint64_t end) {
  uint64_t offset = 0;
  while (!table.empty()) {
    Section section;
    section.bytes = table[0];
    table = table.subspan(1);
    const uint64_t pieces = pieces_in(section.bytes);
    if (pieces > table.size() / 2) return false;
    for (uint64_t i = 0; i < pieces; ++i) {
      const Piece piece{offset, table[2 * i], table[2 * i + 1]};
      if (piece.stored > end - offset || piece.stored > kPieceBytes) return false;
      section.pieces.push_back(piece);
      offset += piece.stored;
    }
    table = table.subspan(2 * pieces);
    sections_.push_back(std::move(section));
  }
  return offset == end;
}

Status WorkFile::read_stored(const Piece& piece, std::span<std::byte> bytes) const {
  if (!file_.read(piece.offset, bytes)) return fail(damaged());
  return hash_of(bytes) == piece.checksum ? Status() : fail(damaged());
}

Status WorkFile::read_piece(const Piece& piece, std::span<std::byte> bytes, std::vector<std::byte>& buffer) const {
  if (piece.stored == bytes.size()) return read_stored(piece, bytes);
  buffer.resize(piece.stored);
  if (Status status = read_stored(piece, buffer); !status) return status;
  return unpack(buffer, bytes) ? Status() : fail(damaged());
}

Status WorkFile::read(size_t section, std::span<std::byte> bytes) const {
  if (section >= sections_.size() || bytes.size() != sections_[section].bytes) return fail(damaged());
  std::vector<std::byte> buffer;
  for (const Piece& piece : sections_[section].pieces) {
    const std::span<std::byte> part = bytes.first(std::min<size_t>(bytes.size(), kPieceBytes));
    if (Status status = read_piece(piece, part, buffer); !status) return status;
    bytes = bytes.subspan(part.size());
  }
  return {};
}

Result<std::vector<std::byte>> WorkFile::read(size_t section) const {
  if (section >= sections_.size()) return fail(damaged());
  std::vector<std::byte> bytes(sections_[section].bytes);
  if (Status status = read(section, bytes); !status) return fail(status);
  return bytes;
}

Status WorkFile::check() const {
  std::vector<std::byte> buffer(kPieceBytes);
  for (const Section& section : sections_) {
    for (const Piece& piece : section.pieces) {
      if (Status status = read_stored(piece, std::span(buffer).first(piece.stored)); !status) return status;
    }
  }
  return {};
}

}  // namespace surfcast::builder
