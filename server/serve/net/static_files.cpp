#include "net/static_files.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <fstream>
#include <optional>
#include <system_error>
#include <utility>

#include "base/hash.h"

namespace surfcast::net {
namespace {

namespace fs = std::filesystem;

constexpr std::array<std::pair<std::string_view, std::string_view>, 13> kMediaTypes{{
    {".html", "text/html; charset=utf-8"},
    {".js", "text/javascript; charset=utf-8"},
    {".css", "text/css; charset=utf-8"},
    {".json", "application/json"},
    {".map", "application/json"},
    {".svg", "image/svg+xml"},
    {".png", "image/png"},
    {".jpg", "image/jpeg"},
    {".webp", "image/webp"},
    {".ico", "image/x-icon"},
    {".woff2", "font/woff2"},
    {".wasm", "application/wasm"},
    {".txt", "text/plain; charset=utf-8"},
}};

std::string_view media_type_of(const fs::path& path) {
  const std::string extension = path.extension().string();
  const auto* const found = std::ranges::find(kMediaTypes, extension, [](const auto& entry) { return entry.first; });
  return found == kMediaTypes.end() ? "application/octet-stream" : found->second;
}

std::string tag_of(const std::vector<std::byte>& content) {
  return '"' + hash_name(content) + '"';
}

/// The builder of the viewer puts what it has named by its content into this folder.
bool is_lasting(std::string_view path) {
  return path.starts_with("/assets/");
}

std::optional<std::vector<std::byte>> read_content(const fs::path& path, uintmax_t bytes) {
  std::vector<std::byte> content(bytes);
  std::ifstream stream(path, std::ios::binary);
  stream.read(reinterpret_cast<char*>(content.data()), static_cast<std::streamsize>(content.size()));
  if (!stream || stream.peek() != std::ifstream::traits_type::eof()) return std::nullopt;
  return content;
}

/// Every plain file below the folder, by its path in a URL.
Result<std::vector<std::pair<std::string, fs::path>>> list_files(const fs::path& folder, size_t most) {
  std::vector<std::pair<std::string, fs::path>> found;
  std::error_code code;
  for (fs::recursive_directory_iterator place(folder, code), end; !code && place != end; place.increment(code)) {
    const bool hidden = place->path().filename().string().starts_with('.');
    if (hidden) place.disable_recursion_pending();
    if (hidden || !fs::is_regular_file(place->symlink_status())) continue;
    found.emplace_back("/" + place->path().lexically_relative(folder).generic_string(), place->path());
    if (found.size() > most) {
      return fail(ErrorKind::kLimit, folder.string() + ": more than " + std::to_string(most) + " files of a viewer");
    }
  }
  if (code) return fail(ErrorKind::kIo, folder.string() + ": cannot be read: " + code.message());
  return found;
}

}  // namespace

Result<StaticFiles> StaticFiles::read(const fs::path& folder, const SiteLimits& limits) {
  const auto listed = list_files(folder, limits.files);
  if (!listed) return fail(listed);
  StaticFiles site;
  uintmax_t total = 0;
  for (const auto& [path, place] : *listed) {
    std::error_code code;
    const uintmax_t bytes = fs::file_size(place, code);
    if (!code) total += bytes;
    if (total > limits.bytes) {
      return fail(ErrorKind::kLimit,
                  folder.string() + ": more than " + std::to_string(limits.bytes) + " bytes of a viewer");
    }
    std::optional<std::vector<std::byte>> content = code ? std::nullopt : read_content(place, bytes);
    if (!content) return fail(ErrorKind::kIo, place.string() + ": cannot be read");
    StaticFile file{std::string(media_type_of(place)), tag_of(*content), is_lasting(path), std::move(*content)};
    site.files_.emplace(path, std::move(file));
  }
  if (site.find("/") == nullptr) return fail(ErrorKind::kNotFound, folder.string() + ": there is no index.html");
  return site;
}

const StaticFile* StaticFiles::find(std::string_view path) const {
  const auto found = files_.find(path == "/" ? "/index.html" : path);
  return found == files_.end() ? nullptr : &found->second;
}

}  // namespace surfcast::net
