#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"

namespace surfcast::net {

/// A file that HTTP serves as it is.
struct StaticFile {
  std::string media_type;
  std::string tag;         ///< of this content, for If-None-Match; quoted
  bool immutable = false;  ///< its name changes with its content: whoever has it need not ask again
  std::vector<std::byte> content;
};

/// What a viewer may hold: its files stay in memory, and a folder that is none is soon given up.
struct SiteLimits {
  size_t files = 1000;
  uintmax_t bytes = uintmax_t{64} << 20;  ///< of all files together
};

/// The files of a folder, read once and found by their path in a URL. A path from outside never reaches the file
/// system.
class StaticFiles {
 public:
  /// Reads every plain file below `folder`; names that begin with a dot and links are left out. Fails when there is no
  /// index.html or the folder holds more than the limits allow.
  static Result<StaticFiles> read(const std::filesystem::path& folder, const SiteLimits& limits = {});

  /// The file at an absolute path without query, "/" being index.html; null when there is none.
  [[nodiscard]] const StaticFile* find(std::string_view path) const;

 private:
  std::map<std::string, StaticFile, std::less<>> files_;
};

}  // namespace surfcast::net
