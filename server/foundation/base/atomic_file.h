#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string_view>

#include "base/result.h"
#include "base/unfinished_file.h"

namespace surfcast {

/// An output file that appears under its name only when it is complete. Bytes go to a temporary file beside the target;
/// `commit` flushes it to disk and renames it. The destructor removes the temporary file unless `commit` was called. So
/// do signals that end the process (see unfinished_file.h).
class AtomicFile {
 public:
  static Result<AtomicFile> create(const std::filesystem::path& target);

  AtomicFile(AtomicFile&& other) noexcept;
  AtomicFile& operator=(AtomicFile&& other) noexcept;
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;
  ~AtomicFile();

  /// Appends; `position()` is the number of bytes appended so far.
  Status append(std::span<const std::byte> bytes);
  /// Overwrites bytes that were already appended, for example a header whose values are known last.
  Status overwrite(size_t offset, std::span<const std::byte> bytes);
  [[nodiscard]] size_t position() const { return position_; }

  Status commit();
  /// The same, but fails where there is a file of that name.
  Status commit_new();
  /// As commit, but does not wait for the disk: if the machine fails, the target may hold anything. For content that is
  /// checked when it is read.
  Status commit_unflushed();

 private:
  AtomicFile(std::filesystem::path target, std::filesystem::path temporary, UnfinishedFile unfinished, int descriptor);
  [[nodiscard]] bool hold() const;
  void discard() noexcept;
  Status commit(int (*move)(const char* from, const char* to));
  Status put_in_place(int (*move)(const char* from, const char* to));

  std::filesystem::path target_;
  std::filesystem::path temporary_;
  UnfinishedFile unfinished_;
  int descriptor_ = -1;
  size_t position_ = 0;
};

/// Removes the temporary files in a folder whose writers ended without doing so: killed, or with the machine. Those of
/// files that are being written, here or by other processes, are locked and stay.
void remove_abandoned_files(const std::filesystem::path& folder);

/// Writes a complete small file atomically.
Status write_file_atomically(const std::filesystem::path& target, std::span<const std::byte> bytes);
Status write_file_atomically(const std::filesystem::path& target, std::string_view text);

}  // namespace surfcast
