#include "cmd/cache_eviction.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <string>
#include <string_view>
#include <system_error>

#include <fcntl.h>
#include <sys/stat.h>

#include "base/file_lock.h"
#include "base/log.h"
#include "model/model_file.h"

namespace surfcast::cmd {
namespace {

namespace fs = std::filesystem;

constexpr int64_t kSecond = 1'000'000'000;  // nanoseconds

/// Whether a name is that of a model in the cache, of any release: VERSION-HASH.surf.
bool is_cached_name(const fs::path& path) {
  constexpr size_t kHashDigits = 32;
  const std::string stem = path.stem().string();
  if (path.extension() != ".surf" || stem.size() < kHashDigits + 2) return false;
  const std::string_view version = std::string_view(stem).substr(0, stem.size() - kHashDigits - 1);
  const std::string_view hash = std::string_view(stem).substr(stem.size() - kHashDigits);
  return stem[version.size()] == '-' && version.find_first_not_of("0123456789.") == std::string_view::npos &&
         hash.find_first_not_of("0123456789abcdef") == std::string_view::npos;
}

/// The files that have the name of a model in the cache. None is read: that would count as use of it.
std::vector<CachedFile> find_cached_files(const fs::path& folder) {
  std::vector<CachedFile> found;
  std::error_code code;
  for (fs::directory_iterator entry(folder, code), end; !code && entry != end; entry.increment(code)) {
    const fs::path& path = entry->path();
    struct stat status {};
    if (!is_cached_name(path) || ::lstat(path.c_str(), &status) != 0 || !S_ISREG(status.st_mode)) continue;
    const int64_t used = int64_t{status.st_atim.tv_sec} * kSecond + status.st_atim.tv_nsec;
    found.push_back({path, static_cast<uint64_t>(status.st_size), used, !FileLock::try_alone(path)});
  }
  return found;
}

/// Whether a file is a model. Reading it may have changed its time of access, which is set back.
bool is_model(const CachedFile& file) {
  const bool opens = model::ModelFile::open(file.path).has_value();
  const std::array<timespec, 2> times{timespec{file.last_used / kSecond, file.last_used % kSecond},
                                      timespec{0, UTIME_OMIT}};
  (void)::utimensat(AT_FDCWD, file.path.c_str(), times.data(), AT_SYMLINK_NOFOLLOW);
  return opens;
}

uint64_t bytes_of(const std::vector<CachedFile>& files) {
  return std::accumulate(files.begin(), files.end(), uint64_t{0},
                         [](uint64_t bytes, const CachedFile& file) { return bytes + file.bytes; });
}

/// Somebody may have begun to use a file meanwhile: then it stays.
void evict(const fs::path& path) {
  const std::optional<FileLock> lock = FileLock::try_alone(path);
  std::error_code code;
  if (!lock || !fs::remove(path, code)) return;
  spdlog::info("cache: removed {}, which was used least recently", path.filename().string());
}

}  // namespace

std::vector<fs::path> files_to_evict(std::vector<CachedFile> files, uint64_t max_bytes) {
  std::ranges::sort(files, {}, &CachedFile::last_used);
  uint64_t bytes = bytes_of(files);
  std::vector<fs::path> evicted;
  for (const CachedFile& file : files) {
    if (bytes <= max_bytes) break;
    if (file.in_use) continue;
    bytes -= file.bytes;
    evicted.push_back(file.path);
  }
  return evicted;
}

uint64_t default_cache_bytes(uint64_t free, uint64_t cached) {
  return std::min(uint64_t{20} << 30, free / 2 + cached / 2);
}

void limit_cache(const fs::path& folder, std::optional<uint64_t> bytes) {
  std::vector<CachedFile> files = find_cached_files(folder);
  std::error_code code;
  const fs::space_info disk = fs::space(folder, code);
  if (code) return;
  const uint64_t most = bytes.value_or(default_cache_bytes(disk.available, bytes_of(files)));
  if (bytes_of(files) <= most) return;
  std::erase_if(files, [](const CachedFile& file) { return !file.in_use && !is_model(file); });
  for (const fs::path& path : files_to_evict(files, most)) evict(path);
}

}  // namespace surfcast::cmd
