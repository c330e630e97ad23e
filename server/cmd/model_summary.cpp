#include "cmd/model_summary.h"

#include <algorithm>
#include <array>
#include <map>
#include <nlohmann/json.hpp>
#include <utility>

#include <spdlog/fmt/fmt.h>

#include "base/ascii_text.h"
#include "base/json_text.h"
#include "cmd/georeference_text.h"
#include "model/volume_facts.h"

namespace surfcast::cmd {
namespace {

/// Names of everything a surfel of the model has.
std::vector<std::string> attribute_names(const model::ModelInfo& info) {
  if (info.surfels == 0) return info.scalar_names;
  std::vector<std::string> names{"position", "normal", "radius", "weight"};
  if (info.color_bits > 0) names.push_back("color");
  names.insert(names.end(), info.scalar_names.begin(), info.scalar_names.end());
  return names;
}

std::string list_text(const std::vector<std::string>& names) {
  return names.empty() ? "none" : joined(names, ", ");
}

std::string text_of(const glm::dvec3& v) {
  return fmt::format("{} {} {}", v.x, v.y, v.z);
}

std::string with_unit(std::string text, const std::string& unit) {
  return unit.empty() ? text : std::move(text) + " " + unit;
}

std::string text_of(const model::Volume& volume) {
  std::string text =
      fmt::format("volume {}: {} x {} x {} samples of {}, spacing {}", volume.name, volume.size.x, volume.size.y,
                  volume.size.z, type_name(volume), with_unit(text_of(spacing_of(volume)), volume.length_unit));
  if (volume.frame != model::WorldFrame::kUnstated) {
    text += fmt::format(", axes {}", frame_name(volume));
  }
  return text +
         fmt::format(", values {}\n", with_unit(fmt::format("{} .. {}", volume.low, volume.high), volume.sample_unit));
}

nlohmann::ordered_json json_of(const glm::dvec3& v) {
  return {v.x, v.y, v.z};
}

nlohmann::ordered_json json_of(const model::Volume& volume) {
  const glm::dmat4x3& axes = volume.index_to_world;
  return {{"name", volume.name},
          {"size", {volume.size.x, volume.size.y, volume.size.z}},
          {"spacing", json_of(spacing_of(volume))},
          {"index_to_world", {json_of(axes[0]), json_of(axes[1]), json_of(axes[2]), json_of(axes[3])}},
          {"frame", frame_name(volume)},
          {"length_unit", volume.length_unit},
          {"type", type_name(volume)},
          {"slope", volume.slope},
          {"intercept", volume.intercept},
          {"low", volume.low},
          {"high", volume.high},
          {"sample_unit", volume.sample_unit}};
}

constexpr std::array kFrames{"", "RAS", "LAS", "LPS"};

std::string frame_of(const model::EllipsoidSource& source) {
  return kFrames.at(static_cast<size_t>(source.frame));
}

std::string text_of(const model::EllipsoidSource& source) {
  const model::EllipsoidCounts& counts = source.counts;
  std::string text = fmt::format("{} {}: {} glyphs of {} {}", source.tensors ? "tensors" : "ellipsoids", source.name,
                                 counts.drawn, counts.samples, source.tensors ? "samples" : "rows");
  if (source.on_grid()) text += fmt::format(" ({} x {} x {})", source.size.x, source.size.y, source.size.z);
  if (source.frame != model::WorldFrame::kUnstated) text += ", axes " + frame_of(source);
  text += fmt::format(", not drawn: {} of low confidence, {} not finite, {} not positive\n", counts.masked,
                      counts.not_finite, counts.not_positive);
  text += fmt::format("  mean FA {:.6f}, mode {:.6f}, {} {}; FA >= 0.2: {}\n", source.mean_anisotropy, source.mean_mode,
                      source.tensors ? "eigenvalues" : "semi-axes",
                      with_unit(text_of(source.mean_values), source.sample_unit), counts.anisotropic);
  for (const model::EllipsoidAttribute& attribute : source.attributes) {
    text += fmt::format("  {}: {} .. {}\n", attribute.name, attribute.smallest, attribute.largest);
  }
  return text;
}

nlohmann::ordered_json json_of(const model::EllipsoidSource& source) {
  const model::EllipsoidCounts& counts = source.counts;
  const glm::dmat4x3& axes = source.index_to_world;
  nlohmann::ordered_json json{{"name", source.name},
                              {"tensors", source.tensors},
                              {"samples", counts.samples},
                              {"drawn", counts.drawn},
                              {"masked", counts.masked},
                              {"not_finite", counts.not_finite},
                              {"not_positive", counts.not_positive},
                              {"anisotropic", counts.anisotropic},
                              {"mean_fa", source.mean_anisotropy},
                              {"mean_mode", source.mean_mode},
                              {"mean_eigenvalues", json_of(source.mean_values)},
                              {"largest", source.largest},
                              {"scale", source.scale()},
                              {"frame", frame_of(source)},
                              {"length_unit", source.length_unit},
                              {"sample_unit", source.sample_unit},
                              {"attributes", nlohmann::ordered_json::array()}};
  if (source.on_grid()) {
    json["size"] = {source.size.x, source.size.y, source.size.z};
    json["index_to_world"] = {json_of(axes[0]), json_of(axes[1]), json_of(axes[2]), json_of(axes[3])};
  }
  for (const model::EllipsoidAttribute& attribute : source.attributes) {
    json["attributes"].push_back(
        {{"attribute", attribute.name}, {"smallest", attribute.smallest}, {"largest", attribute.largest}});
  }
  return json;
}

nlohmann::ordered_json json_of(const LevelSummary& level) {
  return {{"level", level.level},
          {"blocks", level.blocks},
          {"surfels", level.surfels},
          {"bytes", level.bytes},
          {"spacing", {level.smallest_spacing, level.largest_spacing}}};
}

nlohmann::ordered_json json_of(const model::KindCount& kind) {
  return {{"kind", kind.kind}, {"blocks", kind.blocks}, {"count", kind.items}};
}

nlohmann::ordered_json json_of(const model::AttributeRange& range) {
  return {{"attribute", range.attribute},
          {"smallest", range.smallest},
          {"largest", range.largest},
          {"low", range.low},
          {"high", range.high}};
}

nlohmann::ordered_json json_of(const ModelSummary& summary) {
  const model::ModelInfo& info = summary.info;
  nlohmann::ordered_json json{
      {"model", summary.path.string()},
      {"sources", info.source_names},
      {"in_place", info.in_place},
      {"surfels", info.surfels},
      {"scatter", info.scatter},
      {"kinds", nlohmann::ordered_json::array()},
      {"volumes", nlohmann::ordered_json::array()},
      {"bytes", summary.file_bytes},
      {"bytes_per_surfel", summary.bytes_per_surfel()},
      {"bounds", {{"min", json_of(info.bounds.min)}, {"max", json_of(info.bounds.max)}}},
      {"elevation", {{"low", info.elevation.low}, {"high", info.elevation.high}}},
      {"z_up", info.z_up},
      {"upside_down", info.upside_down},
      {"oriented", info.oriented},
      {"mesh_samples", info.even},
      {"color_bits", info.color_bits},
      {"attributes", attribute_names(info)},
      {"ranges", nlohmann::ordered_json::array()},
      {"classes", nlohmann::ordered_json::array()},
      {"levels", nlohmann::ordered_json::array()},
  };
  if (summary.georeference.known()) json["coordinate_system"] = cmd::json_of(summary.georeference);
  for (const model::KindCount& kind : info.kinds) json["kinds"].push_back(json_of(kind));
  for (const model::Volume& volume : summary.volumes) json["volumes"].push_back(json_of(volume));
  for (const model::EllipsoidSource& source : summary.ellipsoids) json["ellipsoids"].push_back(json_of(source));
  for (const model::AttributeRange& range : info.ranges) json["ranges"].push_back(json_of(range));
  for (const model::ClassCount& count : info.classes) {
    json["classes"].push_back({{"code", count.code}, {"surfels", count.surfels}});
  }
  for (const LevelSummary& level : summary.levels) json["levels"].push_back(json_of(level));
  return json;
}

std::string dumped(const nlohmann::ordered_json& json) {
  return json_text(json, 2) + "\n";
}

}  // namespace

ModelSummary summarize(const model::ModelFile& model, uint64_t file_bytes) {
  std::map<int, LevelSummary> levels;
  for (const ldc::BlockEntry& block : model.blocks()) {
    LevelSummary& level = levels[block.level];
    level.level = block.level;
    level.smallest_spacing = level.blocks == 0 ? block.spacing : std::min(level.smallest_spacing, block.spacing);
    level.largest_spacing = std::max(level.largest_spacing, block.spacing);
    ++level.blocks;
    level.surfels += block.items;
    level.bytes += block.bytes;
  }
  const std::span<const model::Volume> volumes = model.volumes();
  ModelSummary summary{model.path(), file_bytes, model.info(), {volumes.begin(), volumes.end()}, {}};
  for (const auto& [number, level] : levels) summary.levels.push_back(level);
  const std::span<const model::EllipsoidSource> ellipsoids = model.ellipsoid_sources();
  summary.ellipsoids.assign(ellipsoids.begin(), ellipsoids.end());
  return summary;
}

std::string to_text(const ModelSummary& summary) {
  const model::ModelInfo& info = summary.info;
  std::string text = fmt::format("model: {}\n", summary.path.string());
  text += fmt::format("sources: {}\n", list_text(info.source_names));
  if (info.in_place)
    text += "in place: blocks are made of its points when they are needed; counts of levels are bounds\n";
  text += fmt::format("surfels: {}\n", info.surfels);
  if (info.scatter > 0) {
    const double share = static_cast<double>(info.scatter) / static_cast<double>(info.surfels);
    text += fmt::format("scatter: {} ({:.1f} % lie on no surface)\n", info.scatter, 100 * share);
  }
  for (const model::KindCount& kind : info.kinds) {
    text += fmt::format("kind {}: {} in {} blocks\n", kind.kind, kind.items, kind.blocks);
  }
  for (const model::Volume& volume : summary.volumes) text += text_of(volume);
  for (const model::EllipsoidSource& source : summary.ellipsoids) text += text_of(source);
  text += fmt::format("bytes: {} ({:.3f} per {})\n", summary.file_bytes, summary.bytes_per_surfel(),
                      info.surfels > 0 ? "surfel" : "item");
  text += fmt::format("bounds: {} .. {}\n", text_of(info.bounds.min), text_of(info.bounds.max));
  text += fmt::format("elevations without outliers: {} .. {}\n", info.elevation.low, info.elevation.high);
  if (summary.georeference.known()) text += "coordinate system: " + name_of(summary.georeference.system) + "\n";
  if (summary.georeference.source.known()) text += "source system: " + name_of(summary.georeference.source) + "\n";
  text += fmt::format("up: {}{}\n", info.upside_down ? "-" : "", info.z_up ? "z" : "y");
  text += fmt::format("oriented: {}\n", info.oriented ? "yes" : info.partly_oriented ? "in part" : "no");
  if (info.even) text += "sampling: even, from meshes\n";
  text += fmt::format("color bits: {}\n", info.color_bits);
  text += fmt::format("attributes: {}\n", list_text(attribute_names(info)));
  for (const model::AttributeRange& range : info.ranges) {
    text += fmt::format("{}: {} .. {}", range.attribute, range.smallest, range.largest);
    const bool tails = range.low > range.smallest || range.high < range.largest;
    text += tails ? fmt::format(" (all but 2 % below {}, all but 2 % above {})\n", range.high, range.low) : "\n";
  }
  for (const model::ClassCount& count : info.classes)
    text += fmt::format("class {}: {} surfels\n", count.code, count.surfels);
  text += fmt::format("levels: {}\n", info.levels);
  for (const LevelSummary& level : summary.levels) {
    text += fmt::format("level {}: {} blocks, {} surfels, {} bytes, spacing {:.6g} .. {:.6g}\n", level.level,
                        level.blocks, level.surfels, level.bytes, level.smallest_spacing, level.largest_spacing);
  }
  return text;
}

std::string to_json(const ModelSummary& summary) {
  return dumped(json_of(summary));
}

std::string to_json(const std::vector<ModelSummary>& members, const ModelSummary* joined) {
  nlohmann::ordered_json json = joined == nullptr ? nlohmann::ordered_json::object() : json_of(*joined);
  json["members"] = nlohmann::ordered_json::array();
  for (const ModelSummary& member : members) json["members"].push_back(json_of(member));
  return dumped(json);
}

}  // namespace surfcast::cmd
