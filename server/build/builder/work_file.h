#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "base/atomic_file.h"
#include "base/positioned_file.h"
#include "base/result.h"

namespace surfcast::builder {

/// What a file of a build in parts holds.
enum class WorkStep : uint32_t { kPart = 1, kSigns, kBlocks, kMerge };

/// Whose work a file is.
struct WorkOwner {
  std::string plan;  ///< digest of the plan
  WorkStep step = WorkStep::kPart;
  uint64_t part = 0;  ///< 0 where the step is one for all parts
  bool operator==(const WorkOwner&) const = default;
};

/// Writes a result of a build in parts: sections of bytes, compressed and with checksums, and whose work it is. The
/// file appears under its name only when it is complete.
class WorkFileWriter {
 public:
  static Result<WorkFileWriter> create(const std::filesystem::path& target, WorkOwner owner);

  /// Appends a section.
  Status add(std::span<const std::byte> section);
  Status finish();

 private:
  WorkFileWriter(AtomicFile file, WorkOwner owner) : file_(std::move(file)), owner_(std::move(owner)) {}

  AtomicFile file_;
  WorkOwner owner_;
  std::vector<uint64_t> table_;  ///< for each section its bytes, and of each piece the stored bytes and their checksum
  uint64_t sections_ = 0;
};

/// Such a file. What is read is checked, so that a file that a shared file system shows in part is no result.
class WorkFile {
 public:
  /// Reads the table at the end. kNotFound without a file, kReplaced where it is the work of another owner,
  /// kInvalidInput where it is damaged. Errors name the file.
  static Result<WorkFile> open(const std::filesystem::path& path, const WorkOwner& owner);

  [[nodiscard]] size_t sections() const { return sections_.size(); }
  [[nodiscard]] uint64_t bytes_of(size_t section) const { return sections_[section].bytes; }
  /// Fills `bytes`, which must be as many as the section has, or fails with kInvalidInput.
  Status read(size_t section, std::span<std::byte> bytes) const;
  [[nodiscard]] Result<std::vector<std::byte>> read(size_t section) const;
  /// Compares all checksums.
  [[nodiscard]] Status check() const;
  /// An error of the content, which names the file.
  [[nodiscard]] Error damaged() const;

 private:
  struct Piece {
    uint64_t offset = 0;  ///< in the file
    uint64_t stored = 0;  ///< bytes in the file: those of the piece itself where they are as many
    uint64_t checksum = 0;
  };
  struct Section {
    uint64_t bytes = 0;
    std::vector<Piece> pieces;
  };

  WorkFile(std::filesystem::path path, PositionedFile file) : path_(std::move(path)), file_(std::move(file)) {}
  Status read_table(const WorkOwner& owner);
  bool take_sections(std::span<const uint64_t> table, uint64_t end);
  Status read_stored(const Piece& piece, std::span<std::byte> bytes) const;
  Status read_piece(const Piece& piece, std::span<std::byte> bytes, std::vector<std::byte>& buffer) const;

  std::filesystem::path path_;
  PositionedFile file_;
  std::vector<Section> sections_;
};

}  // namespace surfcast::builder
