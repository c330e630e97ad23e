#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>

#include "base/result.h"
#include "base/scratch_folder.h"

namespace surfcast::exporter {

/// A folder of files that appears whole, or not at all. Until then it lies in a hidden folder beside its place.
class NewFolder {
 public:
  /// The folder of `target`, a file in it. It must not be there yet, or be empty.
  static Result<NewFolder> create(const std::filesystem::path& target);

  [[nodiscard]] std::string name() const { return folder_.filename().string(); }
  /// Where its files lie until it is put in place.
  [[nodiscard]] const std::filesystem::path& unfinished() const { return unfinished_; }
  [[nodiscard]] Status make_folder(const std::string& name) const;
  /// Writes a file. Safe to use from several threads at once.
  [[nodiscard]] Status write(const std::string& name, std::span<const std::byte> bytes) const;
  /// Flushes everything at once, because there may be very many files, and renames the folder.
  [[nodiscard]] Status put_in_place() const;

 private:
  NewFolder(std::filesystem::path folder, ScratchFolder scratch);
  [[nodiscard]] tl::unexpected<Error> failed(const char* what, const std::string& why) const;

  std::filesystem::path folder_;
  ScratchFolder scratch_;
  std::filesystem::path unfinished_;
};

}  // namespace surfcast::exporter
