#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "base/file_lock.h"
#include "base/result.h"

namespace surfcast {

/// A new folder for files that nobody else needs. It is removed with its content at the end of this object. What a
/// process that is killed leaves, remove_abandoned_folders removes.
class ScratchFolder {
 public:
  /// A folder PREFIX and six characters.
  static Result<ScratchFolder> create(const std::filesystem::path& parent, const std::string& prefix);

  ScratchFolder(ScratchFolder&& other) noexcept;
  ScratchFolder& operator=(ScratchFolder&&) = delete;
  ~ScratchFolder();

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  ScratchFolder(std::filesystem::path path, std::optional<FileLock> lock);

  std::filesystem::path path_;  ///< empty: moved from
  std::optional<FileLock> lock_;
};

/// Removes the folders whose processes have ended: the others are locked. File systems without locks keep theirs.
void remove_abandoned_folders(const std::filesystem::path& parent, const std::string& prefix);

}  // namespace surfcast
