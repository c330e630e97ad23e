#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/atomic_file.h"
#include "base/result.h"

namespace surfcast::net {

/// Which scans clients may send, and where they go. The functions are called on a thread that may wait for the disk.
struct UploadConfig {
  std::filesystem::path folder;                ///< empty: none may be sent; files lie in it by upload_folder
  uint64_t bytes = uint64_t{10} << 30;         ///< of one file at most
  uint64_t total_bytes = uint64_t{100} << 30;  ///< of all files in the folder at most
  size_t at_once = 2;                          ///< files that are being received
  std::chrono::milliseconds timeout{30'000};   ///< for 64 KiB
  std::vector<std::string> extensions;         ///< of names, lower case: ".laz"
  std::vector<std::string> data_extensions;    ///< of files that scans name: kept, and served with them
  /// Whether a model is served under a name.
  std::function<bool(const std::string&)> taken = [](const std::string&) { return false; };
  /// Serves a file that has arrived, or tells what is wrong with it.
  std::function<Status(const std::filesystem::path&)> serve;
};

/// The folder for the files of one sender, by the name of their token; empty: of all who need no token. A scan finds
/// the files that it names in its own folder only, and so none of other senders.
std::filesystem::path upload_folder(const UploadConfig& config, std::string_view sender);

/// The file that a client's name stands for: one name within the sender's folder, of a known extension. Fails with what
/// is wrong with the name.
Result<std::filesystem::path> upload_target(const UploadConfig& config, std::string_view sender, std::string_view name);

/// The extensions of all files that are taken.
std::vector<std::string> all_extensions(const UploadConfig& config);

/// Whether a file is one that scans name, and no model is made of.
bool is_data(const UploadConfig& config, const std::filesystem::path& file);

/// The error of a scan that has more than these bytes.
Error too_large(uint64_t bytes);

/// The folders that files may lie in: that of those without a token, and those of senders.
std::vector<std::filesystem::path> upload_folders(const UploadConfig& config);

/// The complete scans in these folders, sorted by path.
std::vector<std::filesystem::path> uploaded_scans(const UploadConfig& config);

/// A scan on its way: written beside its target, and renamed once it is whole. Its methods wait for the disk. Their
/// errors do not tell where the folder is.
class IncomingScan {
 public:
  /// Fails if the name is taken, and if there is no room for `bytes` beside those that are `reserved` for others. Of a
  /// scan that does not tell its size, as much is taken as there is room for.
  static Result<IncomingScan> create(const UploadConfig& config, const std::filesystem::path& target,
                                     std::optional<uint64_t> bytes, uint64_t reserved);

  Status append(std::span<const std::byte> bytes);
  /// The file is whole: puts it in place and serves it.
  Status finish();

 private:
  IncomingScan(const UploadConfig& config, std::filesystem::path target, AtomicFile file, uint64_t room)
      : config_(&config), target_(std::move(target)), file_(std::move(file)), room_(room) {}

  const UploadConfig* config_;
  std::filesystem::path target_;
  AtomicFile file_;
  uint64_t room_;  ///< bytes that it may have
};

}  // namespace surfcast::net
