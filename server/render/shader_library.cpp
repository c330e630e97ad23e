#include "render/shader_library.h"

#include <algorithm>
#include <set>
#include <sstream>

#include "render/embedded_shaders.h"

namespace surfcast::render {
namespace {

Status append_file(std::string_view name, std::set<std::string, std::less<>>& seen, std::string& text) {
  if (!seen.emplace(name).second) return {};
  const auto files = embedded_shaders();
  const auto file = std::find_if(files.begin(), files.end(), [&](const EmbeddedShader& f) { return f.name == name; });
  if (file == files.end()) return fail(ErrorKind::kInternal, "no shader file " + std::string(name));
  std::istringstream lines{std::string(file->text)};
  constexpr std::string_view kInclude = "#include \"";
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with(kInclude)) {
      const std::string included = line.substr(kInclude.size(), line.rfind('"') - kInclude.size());
      // Headers that C++ reads too include C++ headers between #ifdef __cplusplus; those use angle brackets.
      if (Status status = append_file(included, seen, text); !status) return status;
    } else if (!line.starts_with("#include <")) {
      text += line + '\n';
    }
  }
  return {};
}

}  // namespace

Result<std::string> shader_text(std::string_view name) {
  std::set<std::string, std::less<>> seen;
  std::string text;
  if (Status status = append_file(name, seen, text); !status) return fail(std::move(status.error()));
  return text;
}

}  // namespace surfcast::render
