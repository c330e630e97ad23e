#include "mesh/gltf_materials.h"

#include <cmath>
#include <glm/common.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace surfcast::mesh {
namespace {

UvRule uv_rule(const Json& texture) {
  UvRule rule;
  rule.set = integer_of(texture, "texCoord").value_or(0);
  const Json& transform = member(member(texture, "extensions"), "KHR_texture_transform");
  if (const auto offset = numbers_of(transform, "offset", 2)) rule.offset = {(*offset)[0], (*offset)[1]};
  if (const auto scale = numbers_of(transform, "scale", 2)) rule.scale = {(*scale)[0], (*scale)[1]};
  rule.rotation = number_of(transform, "rotation", 0);
  rule.set = integer_of(transform, "texCoord").value_or(rule.set);
  return rule;
}

Wrap wrap_of(const Json& sampler, const char* axis) {
  constexpr uint64_t kClampToEdge = 33071;
  constexpr uint64_t kMirrored = 33648;
  const std::optional<uint64_t> stated = integer_of(sampler, axis);
  if (stated == kClampToEdge) return Wrap::kClamp;
  return stated == kMirrored ? Wrap::kMirror : Wrap::kRepeat;
}

/// The texture that gives a material its colour, and the factor on it.
struct BaseColor {
  const Json& texture;
  std::optional<std::vector<double>> factor;
};

BaseColor base_color(const Json& material) {
  const Json& gloss = member(member(material, "extensions"), "KHR_materials_pbrSpecularGlossiness");
  if (gloss.is_object()) return {member(gloss, "diffuseTexture"), numbers_of(gloss, "diffuseFactor", 4)};
  const Json& rough = member(material, "pbrMetallicRoughness");
  return {member(rough, "baseColorTexture"), numbers_of(rough, "baseColorFactor", 4)};
}

AlphaMode alpha_mode(const std::string& stated) {
  if (stated == "MASK") return AlphaMode::kMask;
  return stated == "BLEND" ? AlphaMode::kBlend : AlphaMode::kOpaque;
}

bool has_other_maps(const Json& material) {
  return member(material, "normalTexture").is_object() || member(material, "occlusionTexture").is_object() ||
         member(material, "emissiveTexture").is_object() ||
         member(member(material, "pbrMetallicRoughness"), "metallicRoughnessTexture").is_object();
}

/// The image of a texture: that of EXT_texture_webp, if stated, or its own.
std::optional<size_t> image_of_texture(const Json& texture, size_t images) {
  const Json& webp = member(member(texture, "extensions"), "EXT_texture_webp");
  std::optional<uint64_t> source = integer_of(webp, "source");
  if (!source) source = integer_of(texture, "source");
  if (!source || *source >= images) return std::nullopt;
  return static_cast<size_t>(*source);
}

}  // namespace

glm::dvec2 UvRule::apply(const glm::dvec2& uv) const {
  const glm::dvec2 p = uv * scale;
  const double c = std::cos(rotation);
  const double s = std::sin(rotation);
  return glm::dvec2(c * p.x + s * p.y, c * p.y - s * p.x) + offset;
}

GltfMaterial read_gltf_material(const Json& json, const Json& stated, size_t images) {
  const BaseColor base = base_color(stated);
  Material material;
  material.name = text_of(stated, "name");
  if (base.factor) {
    const std::vector<double>& factor = *base.factor;
    material.color = glm::clamp(glm::vec4(factor[0], factor[1], factor[2], factor[3]), 0.0F, 1.0F);
  }
  material.without_image = material.color;
  material.alpha = alpha_mode(text_of(stated, "alphaMode"));
  material.cutoff = static_cast<float>(number_of(stated, "alphaCutoff", 0.5));
  material.culled = !flag_of(stated, "doubleSided");
  if (const std::optional<uint64_t> index = integer_of(base.texture, "index")) {
    const Json& texture = element(member(json, "textures"), *index);
    const std::optional<uint64_t> sampler = integer_of(texture, "sampler");
    const Json& rules = element(member(json, "samplers"), sampler.value_or(UINT64_MAX));
    material.image = image_of_texture(texture, images);
    material.wrap = {wrap_of(rules, "wrapS"), wrap_of(rules, "wrapT")};
  }
  return {std::move(material), uv_rule(base.texture), has_other_maps(stated)};
}

}  // namespace surfcast::mesh
