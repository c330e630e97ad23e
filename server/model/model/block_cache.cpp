#include "model/block_cache.h"

#include <algorithm>
#include <cstring>
#include <system_error>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <spdlog/fmt/fmt.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/atomic_file.h"
#include "base/hash.h"
#include "base/positioned_file.h"
#include "model/format.h"

namespace surfcast::model {
namespace {

namespace fs = std::filesystem;

constexpr const char* kBlockExtension = ".block";
/// Shares of the limit: what is written before the folder is looked through again, and what is free afterwards.
constexpr uint64_t kWrittenShare = 16;
constexpr uint64_t kFreeShare = 8;

/// Of blocks that were made: before their bytes.
constexpr size_t kChecksumBytes = sizeof(uint64_t);

struct KeptBlock {
  fs::path path;
  fs::file_time_type used;
  uint64_t size = 0;
};

/// The blocks in a folder. What else is there is left alone.
std::vector<KeptBlock> blocks_in(const fs::path& folder) {
  std::vector<KeptBlock> blocks;
  std::error_code code;
  for (fs::directory_iterator entry(folder, code), end; !code && entry != end; entry.increment(code)) {
    std::error_code gone;
    if (entry->path().extension() != kBlockExtension || !entry->is_regular_file(gone)) continue;
    const KeptBlock block{entry->path(), entry->last_write_time(gone), entry->file_size(gone)};
    if (!gone) blocks.push_back(block);
  }
  return blocks;
}

/// Notes that a block has been used, in the time of its file.
void mark_used(const fs::path& path) {
  ::utimensat(AT_FDCWD, path.c_str(), nullptr, AT_SYMLINK_NOFOLLOW);
}

}  // namespace

Result<std::shared_ptr<BlockCache>> BlockCache::open(const fs::path& folder, uint64_t bytes) {
  std::error_code code;
  fs::create_directories(folder, code);
  if (code) return fail(ErrorKind::kIo, folder.string() + ": cannot create: " + code.message());
  remove_abandoned_files(folder);
  std::shared_ptr<BlockCache> cache(new BlockCache(folder, bytes));
  cache->remove_oldest();
  return cache;
}

fs::path BlockCache::path_of(uint64_t checksum, uint64_t size) const {
  return folder_ / fmt::format("{:016x}-{}{}", checksum, size, kBlockExtension);
}

bool BlockCache::contains(uint64_t checksum, uint64_t size) const {
  struct stat information {};
  return ::stat(path_of(checksum, size).c_str(), &information) == 0 &&
         static_cast<uint64_t>(information.st_size) == size;
}

bool BlockCache::read(uint64_t checksum, std::span<std::byte> bytes) const {
  const fs::path path = path_of(checksum, bytes.size());
  const Result<PositionedFile> file = PositionedFile::open(path);
  if (!file) return false;
  if (file->size() == bytes.size() && file->read(0, bytes) && checksum_of(bytes) == checksum) {
    mark_used(path);
    return true;
  }
  std::error_code ignored;
  fs::remove(path, ignored);
  return false;
}

void BlockCache::write(uint64_t checksum, std::span<const std::byte> bytes) {
  write_file(path_of(checksum, bytes.size()), bytes);
}

void BlockCache::write_file(const fs::path& path, std::span<const std::byte> bytes) {
  if (bytes.size() > bytes_) return;
  Result<AtomicFile> file = AtomicFile::create(path);
  if (!file || !file->append(bytes) || !file->commit_unflushed()) return;
  if ((written_ += bytes.size()) > bytes_ / kWrittenShare) remove_oldest();
}

fs::path BlockCache::path_of(const std::string& key) const {
  return folder_ / ("made-" + hash_name(std::as_bytes(std::span(key))) + kBlockExtension);
}

bool BlockCache::contains_made(const std::string& key) const {
  std::error_code ignored;
  return fs::is_regular_file(path_of(key), ignored);
}

std::vector<std::byte> BlockCache::read_made(const std::string& key) const {
  const fs::path path = path_of(key);
  const Result<PositionedFile> file = PositionedFile::open(path);
  if (!file) return {};
  std::vector<std::byte> bytes;
  if (file->size() > kChecksumBytes && file->size() <= bytes_) {
    bytes.resize(file->size());
    if (!file->read(0, bytes)) bytes.clear();
  }
  uint64_t checksum = 0;
  if (!bytes.empty()) std::memcpy(&checksum, bytes.data(), kChecksumBytes);
  if (!bytes.empty() && checksum_of(std::span(bytes).subspan(kChecksumBytes)) == checksum) {
    mark_used(path);
    bytes.erase(bytes.begin(), bytes.begin() + kChecksumBytes);
    return bytes;
  }
  std::error_code ignored;
  fs::remove(path, ignored);
  return {};
}

void BlockCache::write_made(const std::string& key, std::span<const std::byte> bytes) {
  const uint64_t checksum = checksum_of(bytes);
  std::vector<std::byte> content(kChecksumBytes + bytes.size());
  std::memcpy(content.data(), &checksum, kChecksumBytes);
  std::ranges::copy(bytes, content.begin() + kChecksumBytes);
  write_file(path_of(key), content);
}

void BlockCache::remove_oldest() {
  const std::unique_lock lock(removal_, std::try_to_lock);
  if (!lock) return;  // another thread is doing it
  written_ = 0;
  std::vector<KeptBlock> blocks = blocks_in(folder_);
  uint64_t total = 0;
  for (const KeptBlock& block : blocks) total += block.size;
  if (total <= bytes_ - bytes_ / kWrittenShare) return;
  std::ranges::sort(blocks, {}, &KeptBlock::used);
  for (const KeptBlock& block : blocks) {
    if (total <= bytes_ - bytes_ / kFreeShare) return;
    std::error_code ignored;
    fs::remove(block.path, ignored);
    total -= block.size;
  }
}

}  // namespace surfcast::model
