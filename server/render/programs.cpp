#include "render/programs.h"

#include <string>

#include "gl/program.h"
#include "render/shader_library.h"

namespace surfcast {
namespace {

Result<gl::Program> compute_program(const char* name, const std::string& defines) {
  Result<std::string> text = shader_text(name);
  if (!text) return fail(std::move(text.error()));
  return gl::make_program(name, {{GL_COMPUTE_SHADER, name, *text}}, defines);
}

std::string defines_of(const Variant& variant) {
  std::string defines;
  if (variant.colored) defines += "#define SURFCAST_HAS_COLOR\n";
  if (variant.lit) defines += "#define SURFCAST_LIT\n";
  if (variant.colored && variant.lit) defines += "#define SURFCAST_LIT_COLOR\n";
  if (variant.float_picture) defines += "#define SURFCAST_FLOAT_PICTURE\n";
  return defines;
}

std::string rows_define(int rows) {
  return "#define SURFCAST_ROWS " + std::to_string(rows) + "\n";
}

}  // namespace

Result<Programs> Programs::create(int rows) {
  Programs programs;
  programs.rows_ = rows;
  Result<gl::Program> offsets = compute_program("bin_offsets.comp", {});
  if (!offsets) return fail(std::move(offsets.error()));
  Result<gl::Program> bin = compute_program("bin.comp", {});
  if (!bin) return fail(std::move(bin.error()));
  programs.bin_offsets_ = std::move(*offsets);
  programs.bin_ = std::move(*bin);
  return programs;
}

Result<const SplatPrograms*> Programs::variant(const Variant& variant) {
  if (const auto found = variants_.find(variant); found != variants_.end()) return &found->second;
  const std::string defines = defines_of(variant);
  Result<gl::Program> project = compute_program("project.comp", defines);
  if (!project) return fail(std::move(project.error()));
  Result<gl::Program> splat = compute_program("splat.comp", defines + rows_define(rows_));
  if (!splat) return fail(std::move(splat.error()));
  Result<gl::Program> large = compute_program("splat.comp", defines + rows_define(1) + "#define SURFCAST_LARGE\n");
  if (!large) return fail(std::move(large.error()));
  SplatPrograms programs{std::move(*project), std::move(*splat), std::move(*large)};
  return &variants_.emplace(variant, std::move(programs)).first->second;
}

}  // namespace surfcast
