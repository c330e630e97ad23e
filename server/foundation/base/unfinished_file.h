#pragma once

#include <filesystem>
#include <utility>

namespace surfcast {

/// Registers a path, which need not exist yet, as an unfinished file for the lifetime of this object. A signal that
/// ends the process removes the file first, once `remove_unfinished_files_on_signals` has been called.
class UnfinishedFile {
 public:
  UnfinishedFile() = default;
  explicit UnfinishedFile(const std::filesystem::path& path);

  UnfinishedFile(UnfinishedFile&& other) noexcept : slot_(std::exchange(other.slot_, kNone)) {}
  UnfinishedFile& operator=(UnfinishedFile&& other) noexcept {
    std::swap(slot_, other.slot_);
    return *this;
  }
  UnfinishedFile(const UnfinishedFile&) = delete;
  UnfinishedFile& operator=(const UnfinishedFile&) = delete;
  ~UnfinishedFile();

 private:
  static constexpr int kNone = -1;
  int slot_ = kNone;
};

/// From this call on SIGINT, SIGTERM and SIGHUP remove all unfinished files before they end the process. Signals that
/// the process ignores stay ignored.
void remove_unfinished_files_on_signals();

}  // namespace surfcast
