#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/result.h"

namespace surfcast::model {

/// Blocks that were read from far away, kept on this disk by their checksums, which are the same in every model that
/// holds the block. Those that were used least recently are removed. Each block is a file that appears whole and is
/// checked when it is read, so that the folder may be shared by processes, damaged, or deleted at any time.
/// Thread-safe.
class BlockCache {
 public:
  /// `bytes`: of all blocks at most; while several processes write, a sixteenth more for each.
  static Result<std::shared_ptr<BlockCache>> open(const std::filesystem::path& folder, uint64_t bytes);

  /// Whether a block of that checksum and size seems to be there.
  [[nodiscard]] bool contains(uint64_t checksum, uint64_t size) const;
  /// Fills `bytes` with the block of that checksum. False if there is none, or a wrong one, which is removed.
  [[nodiscard]] bool read(uint64_t checksum, std::span<std::byte> bytes) const;
  /// Keeps a block. A disk that is full is no error: the block is not kept.
  void write(uint64_t checksum, std::span<const std::byte> bytes);

  // Blocks that are made of something else have no checksum before. They are kept by a key: what they are made of.
  [[nodiscard]] bool contains_made(const std::string& key) const;
  /// Empty if there is none, or a wrong one, which is removed.
  [[nodiscard]] std::vector<std::byte> read_made(const std::string& key) const;
  void write_made(const std::string& key, std::span<const std::byte> bytes);

 private:
  BlockCache(std::filesystem::path folder, uint64_t bytes) : folder_(std::move(folder)), bytes_(bytes) {}
  [[nodiscard]] std::filesystem::path path_of(uint64_t checksum, uint64_t size) const;
  [[nodiscard]] std::filesystem::path path_of(const std::string& key) const;
  void write_file(const std::filesystem::path& path, std::span<const std::byte> bytes);
  void remove_oldest();

  const std::filesystem::path folder_;
  const uint64_t bytes_;
  std::atomic<uint64_t> written_ = 0;  ///< since the folder was looked through
  std::mutex removal_;                 ///< held by the thread that looks through the folder
};

}  // namespace surfcast::model
