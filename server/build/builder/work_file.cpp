#include "builder/work_file.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <utility>

#include "base/contract.h"
#include "base/hash.h"

namespace surfcast::builder {
namespace {

constexpr uint64_t kWorkFileVersion = 1;
/// Bytes with one checksum: enough for the speed of the disk, few enough to be checked with little memory.
constexpr uint64_t kCheckedBytes = uint64_t{1} << 20;
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
  return bytes / kCheckedBytes + (bytes % kCheckedBytes != 0 ? 1 : 0);
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
  for (std::span<const std::byte> rest = section; !rest.empty();) {
    const std::span<const std::byte> piece = rest.first(std::min<size_t>(rest.size(), kCheckedBytes));
    table_.push_back(hash_of(piece));
    rest = rest.subspan(piece.size());
  }
  return file_.append(section);
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
    const uint64_t bytes = table[0];
    if (bytes > end - offset || pieces_in(bytes) > table.size() - 1) return false;
    const std::span<const uint64_t> checksums = table.subspan(1, pieces_in(bytes));
    sections_.push_back({offset, bytes, {checksums.begin(), checksums.end()}});
    offset += bytes;
    table = table.subspan(1 + checksums.size());
  }
  return offset == end;
}

Status WorkFile::read_piece(const Section& section, size_t piece, std::span<std::byte> bytes) const {
  if (!file_.read(section.offset + piece * kCheckedBytes, bytes)) return fail(damaged());
  return hash_of(bytes) == section.checksums[piece] ? Status() : fail(damaged());
}

Status WorkFile::read(size_t section, std::span<std::byte> bytes) const {
  if (section >= sections_.size() || bytes.size() != sections_[section].bytes) return fail(damaged());
  for (size_t piece = 0; !bytes.empty(); ++piece) {
    const std::span<std::byte> part = bytes.first(std::min<size_t>(bytes.size(), kCheckedBytes));
    if (Status status = read_piece(sections_[section], piece, part); !status) return status;
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
  std::vector<std::byte> buffer(kCheckedBytes);
  for (const Section& section : sections_) {
    for (size_t piece = 0; piece < section.checksums.size(); ++piece) {
      const uint64_t rest = section.bytes - piece * kCheckedBytes;
      const auto bytes = std::span(buffer).first(std::min(rest, kCheckedBytes));
      if (Status status = read_piece(section, piece, bytes); !status) return status;
    }
  }
  return {};
}

}  // namespace surfcast::builder
