#include "scan/named_file.h"

#include <algorithm>
#include <charconv>
#include <string>
#include <system_error>

#include "base/ascii_text.h"
#include "scan/text_tokens.h"

namespace surfcast::scan {
namespace {

namespace fs = std::filesystem;

/// True if the file is in the folder or below once links are followed. A file that is not there is in its folder.
bool stays_inside(const fs::path& folder, const fs::path& file) {
  std::error_code code;
  const fs::path root = fs::weakly_canonical(folder.empty() ? fs::path(".") : folder, code);
  if (code) return false;
  const fs::path target = fs::weakly_canonical(file, code);
  if (code) return false;
  return std::mismatch(root.begin(), root.end(), target.begin(), target.end()).first == root.end();
}

bool may_name_a_file(const fs::path& path, std::string_view name) {
  const bool leaves = std::any_of(path.begin(), path.end(), [](const auto& part) { return part == ".."; });
  return !path.empty() && !path.is_absolute() && !leaves && name.find('\0') == std::string_view::npos &&
         name.find("://") == std::string_view::npos;
}

/// `text` with %XX replaced by bytes.
std::string decode_percent(std::string_view text) {
  std::string decoded;
  for (size_t i = 0; i < text.size(); ++i) {
    unsigned value = 0;
    const char* digits = text.data() + i + 1;
    if (text[i] == '%' && i + 3 <= text.size() && std::from_chars(digits, digits + 2, value, 16).ptr == digits + 2) {
      decoded += static_cast<char>(value);
      i += 2;
    } else {
      decoded += text[i];
    }
  }
  return decoded;
}

}  // namespace

std::optional<fs::path> named_file(const fs::path& model, std::string_view name) {
  std::string plain(trimmed(name));
  std::replace(plain.begin(), plain.end(), '\\', '/');
  std::error_code ignored;
  if (!fs::exists(model.parent_path() / plain, ignored)) plain = decode_percent(plain);
  const fs::path path(plain);
  if (!may_name_a_file(path, plain)) return std::nullopt;
  fs::path file = model.parent_path() / path;
  if (!stays_inside(model.parent_path(), file)) return std::nullopt;
  return file;
}

}  // namespace surfcast::scan
