#pragma once

#include <cstddef>
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

/// The files of a folder, read once and found by their path in a URL. A path from outside never reaches the file
/// system.
class StaticFiles {
 public:
  /// Reads every plain file below `folder`; names that begin with a dot and links are left out. Fails when there is no
  /// index.html or the folder holds more than a viewer could.
  static Result<StaticFiles> read(const std::filesystem::path& folder);

  /// The file at an absolute path without query, "/" being index.html; null when there is none.
  [[nodiscard]] const StaticFile* find(std::string_view path) const;

 private:
  std::map<std::string, StaticFile, std::less<>> files_;
};

}  // namespace surfcast::net
