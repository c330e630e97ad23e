// Every shader that the renderer can ask for goes through the Khronos reference compiler: a driver may accept what GLSL
// does not allow. No GL is needed. A stand-in for the driver records the text of each shader as the driver would get
// it.

#include <filesystem>
#include <fstream>
#include <iostream>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <unistd.h>

#include "client/run_program.h"
#include "gl/objects.h"
#include "kinds/kind_table.h"
#include "render/programs.h"
#include "shared/frame_layout.h"

namespace surfcast::testing {
namespace {

namespace fs = std::filesystem;

/// What a device has at least in practice: GL 4.5 promises 8 storage buffers and as many images, and every driver of
/// hardware that has GL 4.5 gives 16 buffer bindings or more.
constexpr int kStorageBlocks = 8;     // of one shader (GL_MAX_COMPUTE_SHADER_STORAGE_BLOCKS)
constexpr int kStorageBindings = 16;  // GL_MAX_SHADER_STORAGE_BUFFER_BINDINGS
constexpr int kImages = 8;            // GL_MAX_IMAGE_UNITS, GL_MAX_COMPUTE_IMAGE_UNIFORMS
constexpr int kTextures = 16;         // GL_MAX_TEXTURE_IMAGE_UNITS
constexpr int kUniformBlocks = 14;    // GL_MAX_COMPUTE_UNIFORM_BLOCKS

/// Takes the place of libepoxy's entry points while it lives, and accepts every shader.
class RecordingDriver {
 public:
  RecordingDriver() {
    texts().clear();
    epoxy_glCreateProgram = [] { return GLuint{1}; };
    epoxy_glCreateShader = [](GLenum) { return GLuint{1}; };
    epoxy_glShaderSource = [](GLuint, GLsizei count, const GLchar* const* parts, const GLint*) {
      std::string text;
      for (GLsizei i = 0; i < count; ++i) text += parts[i];
      texts().insert(text);
    };
    epoxy_glCompileShader = [](GLuint) {};
    epoxy_glGetShaderiv = [](GLuint, GLenum, GLint* value) { *value = GL_TRUE; };
    epoxy_glDeleteShader = [](GLuint) {};
    epoxy_glAttachShader = [](GLuint, GLuint) {};
    epoxy_glLinkProgram = [](GLuint) {};
    epoxy_glObjectLabel = [](GLenum, GLuint, GLsizei, const GLchar*) {};
    epoxy_glGetProgramiv = [](GLuint, GLenum, GLint* value) { *value = GL_TRUE; };
    epoxy_glDeleteProgram = [](GLuint) {};
  }

  /// The texts of all shaders, each once.
  static std::set<std::string>& texts() {
    static std::set<std::string> recorded;
    return recorded;
  }
};

/// Every combination that a request can come to (see variant_of in render/renderer.cpp).
std::vector<render::Variant> all_variants() {
  std::vector<render::Variant> variants;
  for (const picture::SurfelColor color :
       {picture::SurfelColor::kStored, picture::SurfelColor::kIntensity, picture::SurfelColor::kElevation,
        picture::SurfelColor::kClassification, picture::SurfelColor::kNormal}) {
    for (unsigned bits = 0; bits < 512; ++bits) {
      const auto bit = [bits](unsigned place) { return (bits >> place & 1) != 0; };
      render::Variant variant;
      variant.colored = bit(0);
      variant.lit = bit(1);
      variant.float_picture = bit(2);
      variant.color = color;
      variant.hides_classes = bit(3);
      variant.clipped = bit(4);
      variant.eye_dome = bit(5);
      variant.silhouettes = bit(6);
      variant.scatter = bit(7);
      variant.blends_behind = bit(8);
      const bool in_motion = !variant.silhouettes && !variant.float_picture;
      if (variant.blends_behind && !in_motion) continue;
      if (color == picture::SurfelColor::kStored || variant.colored) variants.push_back(variant);
    }
  }
  return variants;
}

/// Every combination of what matters to volumes.
std::vector<render::Variant> volume_variants() {
  std::vector<render::Variant> variants(64);
  for (unsigned bits = 0; bits < variants.size(); ++bits) {
    const auto bit = [bits](unsigned place) { return (bits >> place & 1) != 0; };
    variants[bits].float_picture = bit(0);
    variants[bits].clipped = bit(1);
    variants[bits].shaded = bit(2);
    variants[bits].layered = bit(3);
    variants[bits].volume_surfaces = bit(4);
    variants[bits].depth = bit(5);
  }
  return variants;
}

/// Surfels with curvature, which add a fragment function to the programs for large splats.
void compile_curved(render::Programs& programs, const render::PictureKinds& surfels) {
  for (render::Variant variant : all_variants()) {
    if (variant.hides_classes || variant.clipped || variant.scatter || variant.blends_behind) continue;
    variant.curved = true;
    EXPECT_TRUE(programs.variant(variant, surfels));
    EXPECT_TRUE(programs.long_lists(variant, surfels, SURFCAST_LONG_LIST));
  }
}

/// Surfaces that are kept for what is drawn between them.
void compile_layers(render::Programs& programs, const render::PictureKinds& surfels) {
  for (render::Variant variant : all_variants()) {
    if (!variant.eye_dome || variant.silhouettes || variant.blends_behind) continue;
    variant.layered = true;
    EXPECT_TRUE(programs.variant(variant, surfels));
    EXPECT_TRUE(programs.long_lists(variant, surfels, SURFCAST_LONG_LIST));
  }
}

void compile(render::Programs& programs, const render::Variant& variant, const render::PictureKinds& surfels) {
  EXPECT_TRUE(programs.variant(variant, surfels));
  EXPECT_TRUE(programs.long_lists(variant, surfels, SURFCAST_LONG_LIST));
}

/// The ways to state opacities, which concern the projection.
void compile_opacities(render::Programs& programs, const render::PictureKinds& surfels) {
  for (unsigned bits = 0; bits < 16; ++bits) {
    const auto bit = [bits](unsigned place) { return (bits >> place & 1) != 0; };
    render::Variant variant;
    variant.colored = variant.transparent = true;
    variant.by_file = bit(0);
    variant.by_class = bit(1);
    variant.ghosts = variant.clipped = bit(2);
    variant.xray = bit(3);
    compile(programs, variant, surfels);
    variant.color = picture::SurfelColor::kClassification;
    variant.scatter = variant.curved = true;
    compile(programs, variant, surfels);
  }
}

/// Surfels that are seen through: surfaces, a medium, and surfaces that are kept for what is drawn between them. Each
/// in one way that differs from a plain picture.
void compile_transparent(render::Programs& programs, const render::PictureKinds& surfels) {
  compile_opacities(programs, surfels);
  for (const auto change : {&render::Variant::transparent, &render::Variant::lit, &render::Variant::eye_dome,
                            &render::Variant::float_picture, &render::Variant::blends_behind, &render::Variant::curved,
                            &render::Variant::depth}) {
    for (const bool colored : {false, true}) {
      render::Variant variant;
      variant.colored = colored;
      variant.*change = variant.transparent = true;
      compile(programs, variant, surfels);
      variant.density = true;
      compile(programs, variant, surfels);
      variant.density = false;
      variant.layered = variant.eye_dome = true;
      if (!variant.blends_behind) compile(programs, variant, surfels);
    }
  }
}

/// Gaussians alone with the depths of the pixels, and between surfaces, drawn or kept for volumes.
void compile_gaussians_between(render::Programs& programs) {
  for (const auto form : {render::GaussianForm::kTrained, render::GaussianForm::kFlat, render::GaussianForm::kExact}) {
    render::Variant alone;
    alone.depth = true;
    EXPECT_TRUE(programs.gaussians(alone, form));
    for (unsigned bits = 0; bits < 8; ++bits) {
      render::Variant variant;
      variant.layered = true;
      variant.keeps = (bits & 1) != 0;
      variant.float_picture = (bits & 2) != 0;
      variant.depth = (bits & 4) != 0;
      EXPECT_TRUE(programs.gaussians(variant, form));
    }
  }
}

/// One volume and several, alone, between surfaces and between Gaussians.
void compile_volumes(render::Programs& programs) {
  for (render::Variant variant : volume_variants()) {
    for (const size_t volumes : {1, 2, 4}) EXPECT_TRUE(programs.volumes(variant, volumes));
    if (!variant.layered) continue;
    variant.codes = true;
    for (const size_t volumes : {1, 2}) EXPECT_TRUE(programs.volumes(variant, volumes));
  }
}

/// Ellipsoids and superquadrics in pictures, beside surfaces and among what is drawn between these.
void compile_ellipsoids(render::Programs& programs) {
  for (const auto target : {render::EllipsoidTarget::kPicture, render::EllipsoidTarget::kBesideSurfaces,
                            render::EllipsoidTarget::kLayers}) {
    for (unsigned bits = 0; bits < 32; ++bits) {
      render::Variant variant;
      variant.depth = (bits & 1) != 0;
      variant.superquadrics = (bits & 2) != 0;
      variant.clipped = (bits & 4) != 0;
      variant.float_picture = (bits & 8) != 0;
      variant.blends_behind = (bits & 16) != 0;
      EXPECT_TRUE(programs.ellipsoids(variant, /*mapped=*/variant.clipped, target));
    }
  }
}

/// The texts of the shaders of all variants, for processors and for GPUs.
std::set<std::string> all_shaders() {
  const RecordingDriver driver;
  const render::PictureKinds surfels{{kinds::built_in_kinds().front(), 0}};
  for (const render::KernelShape& shape : {render::software_kernels(), render::KernelShape()}) {
    Result<render::Programs> programs = render::Programs::create(shape, {});
    EXPECT_TRUE(programs) << programs.error().message;
    for (const render::Variant& variant : all_variants()) {
      const Result<render::SplatPrograms> compiled = programs->variant(variant, surfels);
      EXPECT_TRUE(compiled) << compiled.error().message;
      const Result<render::LongListPrograms> groups = programs->long_lists(variant, surfels, SURFCAST_LONG_LIST);
      EXPECT_TRUE(groups) << groups.error().message;
    }
    for (render::Variant variant : all_variants()) {
      for (const int degree : {1, 4}) {
        variant.harmonics = degree;
        for (const auto form :
             {render::GaussianForm::kTrained, render::GaussianForm::kFlat, render::GaussianForm::kExact}) {
          EXPECT_TRUE(programs->gaussians(variant, form));
        }
      }
    }
    compile_curved(*programs, surfels);
    compile_layers(*programs, surfels);
    compile_transparent(*programs, surfels);
    compile_gaussians_between(*programs);
    compile_volumes(*programs);
    compile_ellipsoids(*programs);
    // Work groups of another size.
    EXPECT_TRUE(programs->long_lists(all_variants().back(), surfels, uint32_t{1} << 20));
  }
  return RecordingDriver::texts();
}

/// What tells a shader from its variants.
std::string defines_of(const std::string& text) {
  std::string defines;
  std::istringstream lines(text);
  std::string line;
  std::getline(lines, line);  // #version
  while (std::getline(lines, line) && line.starts_with("#define ")) defines += line.substr(8) + "; ";
  return defines;
}

/// A folder with a file for each shader, by number.
class ShaderFolder {
 public:
  ShaderFolder() : path_(fs::path(::testing::TempDir()) / ("surfcast_shaders_" + std::to_string(getpid()))) {
    fs::create_directories(path_);
    for (const std::string& text : all_shaders()) {
      files_.push_back(path_ / (std::to_string(texts_.size()) + ".comp"));
      std::ofstream(files_.back()) << text;
      texts_.push_back(text);
    }
  }
  ~ShaderFolder() { fs::remove_all(path_); }
  ShaderFolder(const ShaderFolder&) = delete;
  ShaderFolder& operator=(const ShaderFolder&) = delete;

  [[nodiscard]] const std::vector<std::string>& texts() const { return texts_; }

  /// Runs the reference compiler over all shaders in one go: most of its time is the start.
  [[nodiscard]] client::ProgramOutcome compile(const std::string& options) const {
    std::string line = "glslangValidator " + options;
    for (const fs::path& file : files_) line += " '" + file.string() + "'";
    return client::run_program(line + " 2>&1");
  }
  [[nodiscard]] client::ProgramOutcome compile_one(size_t shader) const {
    return client::run_program("glslangValidator -C '" + files_[shader].string() + "' 2>&1");
  }

 private:
  fs::path path_;
  std::vector<fs::path> files_;
  std::vector<std::string> texts_;
};

/// Without an error or a warning.
bool is_clean(const client::ProgramOutcome& outcome) {
  return outcome.code == 0 && outcome.output.find("WARNING") == std::string::npos;
}

/// The texts of all shaders with macros and conditions resolved.
std::vector<std::string> preprocessed(const ShaderFolder& folder) {
  const std::string all = folder.compile("-E").output;
  std::vector<std::string> texts;
  for (size_t from = all.find("#version"); from != std::string::npos;) {
    const size_t next = all.find("#version", from + 1);
    texts.push_back(all.substr(from, next - from));
    from = next;
  }
  return texts;
}

/// The declarations of a shader that have a binding, each from the word `binding` on. std::regex is slow, so it
/// searches these instead of the whole text.
std::vector<std::string> bound_declarations(const std::string& text) {
  std::vector<std::string> declarations;
  for (size_t at = text.find("binding"); at != std::string::npos; at = text.find("binding", at + 1)) {
    const size_t end = text.find_first_of(";{", at);
    declarations.push_back(text.substr(at, end == std::string::npos ? end : end + 1 - at));
  }
  return declarations;
}

/// Numbers of the bindings of the declarations that match, each once.
std::set<int> bindings(const std::vector<std::string>& declarations, const std::string& wanted) {
  const std::regex pattern(R"(binding *= *(\d+)[^)]*\)[^;{]*\b)" + wanted);
  std::set<int> found;
  std::smatch match;
  for (const std::string& declaration : declarations) {
    if (std::regex_search(declaration, match, pattern, std::regex_constants::match_continuous)) {
      found.insert(std::stoi(match[1]));
    }
  }
  return found;
}

TEST(ShaderValidation, TheReferenceCompilerAcceptsEveryShader) {
  const ShaderFolder folder;
  ASSERT_GT(folder.texts().size(), 100U);
  const client::ProgramOutcome all = folder.compile("-C");
  ASSERT_NE(all.code, 127) << "glslangValidator (package glslang-tools) is missing";
  std::cout << "[ measured ] " << folder.texts().size() << " shaders\n";
  if (is_clean(all)) return;
  for (size_t i = 0; i < folder.texts().size(); ++i) {
    const client::ProgramOutcome one = folder.compile_one(i);
    EXPECT_TRUE(is_clean(one)) << defines_of(folder.texts()[i]) << '\n' << one.output;
  }
  EXPECT_TRUE(is_clean(all));
}

TEST(ShaderValidation, EveryShaderStaysWithinTheLimitsOfDevices) {
  const ShaderFolder folder;
  const std::vector<std::string> texts = preprocessed(folder);
  ASSERT_EQ(texts.size(), folder.texts().size());
  for (size_t i = 0; i < texts.size(); ++i) {
    const std::string shader = defines_of(folder.texts()[i]);
    const std::vector<std::string> declarations = bound_declarations(texts[i]);
    const std::set<int> storage = bindings(declarations, "buffer\\b");
    ASSERT_FALSE(storage.empty()) << shader;
    EXPECT_LE(storage.size(), static_cast<size_t>(kStorageBlocks)) << shader;
    EXPECT_LT(*storage.rbegin(), kStorageBindings) << shader;
    for (const auto& [declaration, most] :
         {std::pair("u?image\\w+", kImages), {"u?sampler\\w+", kTextures}, {"uniform +\\w+ *\\{", kUniformBlocks}}) {
      const std::set<int> used = bindings(declarations, declaration);
      EXPECT_LE(used.size(), static_cast<size_t>(most)) << declaration << ' ' << shader;
      EXPECT_TRUE(used.empty() || *used.rbegin() < most) << declaration << ' ' << shader;
    }
  }
}

}  // namespace
}  // namespace surfcast::testing
