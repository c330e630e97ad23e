#include "net/uploads.h"

#include <algorithm>
#include <cctype>
#include <system_error>
#include <utility>

#include <spdlog/fmt/fmt.h>

#include "access/secret.h"
#include "base/ascii_text.h"
#include "protocol/errors.h"
#include "service/model_name.h"

namespace surfcast::net {
namespace {

namespace fs = std::filesystem;

/// Bytes of a name. Not a setting: file systems end at 255, and the temporary file's name is longer.
constexpr size_t kLongestName = 200;

/// Whether a name stays within its folder, is not hidden, and can be listed as it is.
bool is_plain(std::string_view name) {
  const auto wrong = [](unsigned char c) { return c < 0x20 || c == 0x7f || c == '/' || c == '\\' || c == ':'; };
  return !name.empty() && name.front() != '.' && std::ranges::none_of(name, wrong) &&
         protocol::clean_utf8(name) == name;
}

std::string known_extensions(const UploadConfig& config) {
  std::string list;
  for (const std::string& extension : all_extensions(config)) list += (list.empty() ? "" : " ") + extension;
  return list;
}

tl::unexpected<Error> taken(const fs::path& target) {
  return fail(ErrorKind::kInvalidInput, target.filename().string() + ": there is a model or scan of that name already");
}

bool ends_with_any(const fs::path& file, const std::vector<std::string>& extensions) {
  const std::string name = to_lower(file.filename().string());
  return std::ranges::any_of(extensions, [&](const std::string& extension) {
    return name.size() > extension.size() && name.ends_with(extension);
  });
}

/// Before the name of a sender in that of their folder. No scan's name begins like a folder and has no extension.
constexpr std::string_view kSenderPrefix = "sender-";

/// A name of which other names cannot be the same file: what is not plain stands as %XX, and a long one as its hash.
std::string folder_name(std::string_view sender) {
  std::string name(kSenderPrefix);
  for (const char c : sender) {
    const bool plain = std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-' || c == '_';
    name += plain ? std::string(1, c) : fmt::format("%{:02X}", static_cast<unsigned char>(c));
  }
  return name.size() <= kLongestName ? name : std::string(kSenderPrefix) + "%%" + access::sha256(sender);
}

/// Whether a name stays within a folder and is that of a scan or of its data.
Status check_name(const UploadConfig& config, std::string_view name) {
  if (!is_plain(name)) {
    return fail(ErrorKind::kInvalidInput, "the name must be that of a file, without folders and a leading dot");
  }
  if (name.size() > kLongestName) {
    return fail(ErrorKind::kInvalidInput, "the name is longer than " + std::to_string(kLongestName) + " bytes");
  }
  if (!ends_with_any(name, config.extensions) && !is_data(config, name)) {
    return fail(ErrorKind::kUnsupported,
                std::string(name) + ": not a scan by its name; known are " + known_extensions(config));
  }
  return {};
}

/// The complete files of all senders.
std::vector<fs::path> uploaded_files(const UploadConfig& config) {
  std::vector<fs::path> files;
  for (const fs::path& folder : upload_folders(config)) {
    std::error_code code;
    for (fs::directory_iterator entry(folder, code), end; !code && entry != end; entry.increment(code)) {
      std::error_code ignored;
      const bool named = check_name(config, entry->path().filename().string()).has_value();
      if (named && entry->is_regular_file(ignored)) files.push_back(entry->path());
    }
  }
  return files;
}

uint64_t bytes_in_folder(const UploadConfig& config) {
  uint64_t sum = 0;
  for (const fs::path& file : uploaded_files(config)) {
    std::error_code code;
    const uint64_t bytes = fs::file_size(file, code);
    if (!code) sum += bytes;
  }
  return sum;
}

/// Bytes that a further scan may have.
uint64_t room_in_folder(const UploadConfig& config, uint64_t reserved) {
  std::error_code code;
  const fs::space_info disk = fs::space(config.folder, code);
  const uint64_t on_disk = code ? config.total_bytes : disk.available;
  const uint64_t within_total = config.total_bytes - std::min(config.total_bytes, bytes_in_folder(config));
  const uint64_t room = std::min(on_disk, within_total);
  return std::min(config.bytes, room - std::min(room, reserved));
}

/// The error with the file's name in place of its path.
Error without_folder(Error error, const fs::path& target) {
  const std::string path = target.string();
  const std::string name = target.filename().string();
  for (size_t at = error.message.find(path); at != std::string::npos; at = error.message.find(path, at + name.size())) {
    error.message.replace(at, path.size(), name);
  }
  return error;
}

}  // namespace

fs::path upload_folder(const UploadConfig& config, std::string_view sender) {
  return sender.empty() ? config.folder : config.folder / folder_name(sender);
}

Result<fs::path> upload_target(const UploadConfig& config, std::string_view sender, std::string_view name) {
  if (Status checked = check_name(config, name); !checked) return fail(checked);
  return upload_folder(config, sender) / name;
}

std::vector<fs::path> upload_folders(const UploadConfig& config) {
  std::vector<fs::path> folders{config.folder};
  std::error_code code;
  for (fs::directory_iterator entry(config.folder, code), end; !code && entry != end; entry.increment(code)) {
    std::error_code ignored;
    const bool folder = entry->is_directory(ignored) && !entry->is_symlink(ignored);
    if (folder && entry->path().filename().string().starts_with(kSenderPrefix)) folders.push_back(entry->path());
  }
  return folders;
}

std::vector<std::string> all_extensions(const UploadConfig& config) {
  std::vector<std::string> all = config.extensions;
  all.insert(all.end(), config.data_extensions.begin(), config.data_extensions.end());
  return all;
}

bool is_data(const UploadConfig& config, const fs::path& file) {
  return !ends_with_any(file, config.extensions) && ends_with_any(file, config.data_extensions);
}

Error too_large(uint64_t bytes) {
  return {ErrorKind::kLimit, "larger than the " + std::to_string(bytes) + " bytes that are taken"};
}

std::vector<fs::path> uploaded_scans(const UploadConfig& config) {
  std::vector<fs::path> scans = uploaded_files(config);
  std::erase_if(scans, [&](const fs::path& file) { return is_data(config, file); });
  std::ranges::sort(scans);
  return scans;
}

Result<IncomingScan> IncomingScan::create(const UploadConfig& config, const fs::path& target,
                                          std::optional<uint64_t> bytes, uint64_t reserved) {
  std::error_code code;
  const bool served = !is_data(config, target) && config.taken(service::model_name(target));
  if (fs::exists(fs::symlink_status(target, code)) || served) return taken(target);
  const uint64_t room = room_in_folder(config, reserved);
  if (room == 0 || bytes.value_or(0) > room) {
    return fail(ErrorKind::kUnavailable, target.filename().string() + ": the server has no room for it");
  }
  fs::create_directory(target.parent_path(), code);  // if that fails, so does the file
  Result<AtomicFile> file = AtomicFile::create(target);
  if (!file) return fail(without_folder(std::move(file.error()), target));
  return IncomingScan(config, target, std::move(*file), bytes.value_or(room));
}

Status IncomingScan::append(std::span<const std::byte> bytes) {
  if (bytes.size() > room_ - file_.position()) return fail(too_large(room_));
  return file_.append(bytes).map_error([&](Error error) { return without_folder(std::move(error), target_); });
}

Status IncomingScan::finish() {
  std::error_code code;
  if (fs::exists(fs::symlink_status(target_, code))) return taken(target_);
  Status status = file_.commit_new();
  if (!status) return fail(without_folder(std::move(status.error()), target_));
  if (is_data(*config_, target_)) return {};
  status = config_->serve(target_);
  if (status) return {};
  fs::remove(target_, code);
  return fail(without_folder(std::move(status.error()), target_));
}

}  // namespace surfcast::net
