#pragma once

#include <filesystem>
#include <utility>

namespace surfcast {

/// Marks the file of that name, which need not exist yet, as unfinished for as long as this lives: a signal that ends
/// the process removes it first, once `remove_unfinished_files_on_signals` has been called.
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

/// From here on SIGINT, SIGTERM and SIGHUP remove all unfinished files before they end the process, as far as nobody
/// else handles or ignores them.
void remove_unfinished_files_on_signals();

}  // namespace surfcast
