#include "render/shader_library.h"

#include <algorithm>
#include <set>
#include <sstream>

namespace surfcast::render {
namespace {

class Assembler {
 public:
  explicit Assembler(std::span<const EmbeddedShader> more) : more_(more) {}

  Status append_file(std::string_view name) {
    if (!seen_.emplace(name).second) return {};
    const EmbeddedShader* file = find(name);
    if (file == nullptr) return fail(ErrorKind::kInternal, "no shader file " + std::string(name));
    std::istringstream lines{std::string(file->text)};
    constexpr std::string_view kInclude = "#include \"";
    for (std::string line; std::getline(lines, line);) {
      if (line.starts_with(kInclude)) {
        const std::string included = line.substr(kInclude.size(), line.rfind('"') - kInclude.size());
        if (more_.empty() && included.starts_with("kinds/")) continue;
        // Headers shared with C++ include C++ headers within #ifdef __cplusplus, in angle brackets.
        if (Status status = append_file(included); !status) return status;
      } else if (!line.starts_with("#include <")) {
        text_ += line + '\n';
      }
    }
    return {};
  }
  [[nodiscard]] std::string take() && { return std::move(text_); }

 private:
  [[nodiscard]] const EmbeddedShader* find(std::string_view name) const {
    for (const std::span<const EmbeddedShader> files : {more_, embedded_shaders()}) {
      const auto file = std::ranges::find(files, name, &EmbeddedShader::name);
      if (file != files.end()) return &*file;
    }
    return nullptr;
  }

  std::span<const EmbeddedShader> more_;
  std::set<std::string, std::less<>> seen_;
  std::string text_;
};

}  // namespace

Result<std::string> shader_text(std::string_view name, std::span<const EmbeddedShader> more) {
  Assembler assembler(more);
  if (Status status = assembler.append_file(name); !status) return fail(status);
  return std::move(assembler).take();
}

}  // namespace surfcast::render
