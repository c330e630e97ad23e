#include "model/joined_model.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "base/contract.h"
#include "model/model_counts.h"
#include "surfel/conform_scalars.h"
#include "surfel/curvature.h"
#include "surfel/opacity.h"

namespace surfcast::model {
namespace {

bool has_surfels(const Member& member) {
  return member.model->info().surfels > 0;
}

/// Whether all members with surfels have a property; without any surfels, whether all members have it.
template <typename Has>
bool all_scans(std::span<const Member> members, const Has& has) {
  const bool any = std::ranges::any_of(members, has_surfels);
  return std::ranges::all_of(
      members, [&](const Member& member) { return (any && !has_surfels(member)) || has(member.model->info()); });
}

/// Adds the attributes of a member to those of the members before it.
void merge_columns(std::span<const ScalarColumn> more, std::vector<ScalarColumn>& merged) {
  for (const ScalarColumn& column : more) {
    const auto known = std::ranges::find(merged, column.name, &ScalarColumn::name);
    if (known == merged.end()) {
      merged.push_back(column);
    } else {
      known->type = surfel::common_type(known->type, column.type);
      known->coarse = known->coarse || column.coarse;
    }
  }
}

/// The number that stands for full opacity in a column of this type.
double full_opacity_of_type(ScalarCode type) {
  return surfel::full_opacity(surfel::filling({}, type, 0));
}

/// A range of a member in the unit of the joined column. Only opacities have units that depend on the type.
AttributeRange in_unit_of(AttributeRange range, ScalarCode from, ScalarCode to) {
  if (range.attribute != surfel::kOpacityAttribute || from == to) return range;
  const double factor = full_opacity_of_type(to) / full_opacity_of_type(from);
  for (double* const value : {&range.smallest, &range.largest, &range.low, &range.high}) *value *= factor;
  return range;
}

void merge_range(const AttributeRange& range, std::vector<AttributeRange>& merged) {
  const auto known = std::ranges::find(merged, range.attribute, &AttributeRange::attribute);
  if (known == merged.end()) {
    merged.push_back(range);
    return;
  }
  known->smallest = std::min(known->smallest, range.smallest);
  known->largest = std::max(known->largest, range.largest);
  known->low = std::min(known->low, range.low);
  known->high = std::max(known->high, range.high);
}

ScalarCode type_in(std::span<const ScalarColumn> columns, const std::string& name) {
  const auto found = std::ranges::find(columns, name, &ScalarColumn::name);
  return found == columns.end() ? ScalarCode{0} : found->type;
}

std::vector<AttributeRange> merged_ranges(std::span<const Member> members, std::span<const ScalarColumn> scalars) {
  std::vector<AttributeRange> ranges;
  for (const Member& member : members) {
    for (const AttributeRange& range : member.model->info().ranges) {
      const ScalarCode own = type_in(member.model->scalars(), range.attribute);
      merge_range(in_unit_of(range, own, type_in(scalars, range.attribute)), ranges);
    }
  }
  return ranges;
}

/// Surfels of members without classes have the class 0, as they are drawn.
std::vector<ClassCount> merged_classes(std::span<const Member> members) {
  std::map<uint32_t, uint64_t> counts;
  uint64_t without = 0;
  for (const Member& member : members) {
    const ModelInfo& info = member.model->info();
    if (info.classes.empty()) without += info.surfels;
    for (const ClassCount& of : info.classes) counts[of.code] += of.surfels;
  }
  if (counts.empty()) return {};
  if (without > 0) counts[0] += without;
  std::vector<ClassCount> classes;
  classes.reserve(counts.size());
  for (const auto& [code, surfels] : counts) classes.push_back({code, surfels});
  return classes;
}

/// The number of a kind in the joined model.
uint8_t kind_number(const std::string& kind, std::vector<KindCount>& kinds) {
  const auto found = std::ranges::find(kinds, kind, &KindCount::kind);
  if (found == kinds.end()) kinds.push_back({kind, 0, 0});
  return static_cast<uint8_t>(std::ranges::find(kinds, kind, &KindCount::kind) - kinds.begin());
}

geometry::Box placed(const geometry::Box& box, const glm::dmat4x3& place) {
  geometry::Box placed;
  for (int corner = 0; corner < 8; ++corner) {
    const auto of = [&](int axis) { return (corner >> axis & 1) == 0 ? box.min[axis] : box.max[axis]; };
    placed.include(place * glm::dvec4(of(0), of(1), of(2), 1));
  }
  return placed;
}

/// The factor of lengths. Maps between coordinate systems stretch all directions by about the same.
double stretch(const glm::dmat4x3& place) {
  return std::cbrt(std::abs(glm::determinant(glm::dmat3(place[0], place[1], place[2]))));
}

/// Turns and stretches without shear, so that normals are turned as directions are.
glm::dmat3 turn_of(const glm::dmat4x3& place) {
  return glm::dmat3(place[0], place[1], place[2]) / stretch(place);
}

ldc::BlockEntry placed(ldc::BlockEntry entry, const glm::dmat4x3& place) {
  entry.bounds = placed(entry.bounds, place);
  entry.spacing *= stretch(place);
  entry.max_radius *= stretch(place);
  if (entry.normals) {
    entry.normals->axis = glm::normalize(glm::vec3(turn_of(place) * glm::dvec3(entry.normals->axis)));
  }
  return entry;
}

/// A lattice for the points of a block in another place: steps of a power of two, at most as long as the shortest of
/// the lattice before, so that rounding moves points by less than half of that. Blocks of a member share it.
surfel::Grid placed_grid(const surfel::Grid& grid, const geometry::Box& bounds, const glm::dmat4x3& place) {
  constexpr double kMaxSteps = 0x1p30;  // of the indices of a block
  const double shortest = std::min({grid.scale.x, grid.scale.y, grid.scale.z}) * stretch(place);
  const glm::dvec3 size = bounds.size();
  const double least = std::max({size.x, size.y, size.z}) / kMaxSteps;
  double step = std::exp2(std::floor(std::log2(shortest)));
  while (step < least) step *= 2;
  return {glm::dvec3(step), glm::dvec3(0)};
}

/// The entries of the blocks of a member in the joined model. Parents are still those of the member.
std::vector<ldc::BlockEntry> entries_of(const Member& member, JoinedTables& tables) {
  const ModelFile& model = *member.model;
  std::vector<uint8_t> kinds;
  for (const KindCount& kind : model.info().kinds) kinds.push_back(kind_number(kind.kind, tables.info.kinds));
  std::vector<ldc::BlockEntry> entries(model.blocks().begin(), model.blocks().end());
  for (size_t i = 0; i < entries.size(); ++i) {
    if (!member.places.empty()) entries[i] = placed(entries[i], member.places[i]);
    entries[i].kind = kinds[entries[i].kind];
  }
  return entries;
}

/// The blocks of surfels without a parent.
std::vector<TopBlock> top_blocks(std::span<const Member> members, std::span<const std::vector<ldc::BlockEntry>> entries,
                                 const ModelInfo& info) {
  std::vector<TopBlock> tops;
  for (uint32_t member = 0; member < members.size(); ++member) {
    const ldc::BlockTree& tree = members[member].model->tree();
    for (const uint32_t root : tree.roots()) {
      const ldc::BlockEntry& entry = entries[member][root];
      if (info.kinds[entry.kind].kind != kSurfelKind) continue;
      const bool leaf = tree.children(root).count == 0;
      tops.push_back({entry, member, root, leaf, members[member].model->info().oriented});
    }
  }
  return tops;
}

/// The numbers of the blocks of each member in the joined model.
using BlockNumbers = std::vector<std::vector<uint32_t>>;
constexpr uint32_t kNoNumber = UINT32_MAX;

/// Adds the levels above the members, with their top blocks.
void add_member_levels(const std::vector<TopBlock>& tops, JoinedTables& tables, BlockNumbers& numbers) {
  MemberLevels levels = plan_member_levels(tops);
  for (const MemberLevelNode& node : levels.nodes) {
    if (node.top == MemberLevelNode::kShared) {
      tables.parts.origins.push_back({BlockOrigin::kShared, node.shared});
    } else {
      const TopBlock& top = tops[node.top];
      numbers[top.member][top.block] = static_cast<uint32_t>(tables.blocks.size());
      tables.parts.origins.push_back({top.member, top.block});
    }
    tables.blocks.push_back(node.entry);
  }
  tables.parts.shared = std::move(levels.shared);
}

/// Adds the blocks of a member that have not been added. Parents precede their children.
void add_other_blocks(uint32_t member, std::span<const ldc::BlockEntry> entries, JoinedTables& tables,
                      std::vector<uint32_t>& numbers) {
  for (uint32_t block = 0; block < entries.size(); ++block) {
    if (numbers[block] != kNoNumber) continue;
    numbers[block] = static_cast<uint32_t>(tables.blocks.size());
    ldc::BlockEntry entry = entries[block];
    if (entry.parent != ldc::BlockEntry::kNoParent) entry.parent = numbers[entry.parent];
    tables.parts.origins.push_back({member, block});
    tables.blocks.push_back(entry);
  }
}

void add_blocks(std::span<const std::vector<ldc::BlockEntry>> entries, JoinedTables& tables) {
  BlockNumbers numbers;
  for (const std::vector<ldc::BlockEntry>& own : entries) numbers.emplace_back(own.size(), kNoNumber);
  add_member_levels(top_blocks(tables.parts.members, entries, tables.info), tables, numbers);
  for (uint32_t member = 0; member < entries.size(); ++member) {
    add_other_blocks(member, entries[member], tables, numbers[member]);
  }
}

/// Adds volumes and sources of ellipsoids of a member.
void add_sources(const ModelFile& model, JoinedTables& tables) {
  tables.parts.offsets.push_back(
      {static_cast<uint32_t>(tables.volumes.size()), static_cast<uint32_t>(tables.ellipsoids.size())});
  tables.volumes.insert(tables.volumes.end(), model.volumes().begin(), model.volumes().end());
  tables.ellipsoids.insert(tables.ellipsoids.end(), model.ellipsoid_sources().begin(), model.ellipsoid_sources().end());
}

/// What the members have in common, but for what follows from the blocks.
void describe(std::span<const Member> members, JoinedTables& tables) {
  ModelInfo& info = tables.info;
  const ModelInfo& first = members.front().model->info();
  info.z_up = first.z_up;
  info.upside_down = first.upside_down;
  info.oriented = all_scans(members, [](const ModelInfo& one) { return one.oriented; });
  info.partly_oriented = std::ranges::any_of(
      members, [](const Member& one) { return one.model->info().partly_oriented && one.model->info().surfels > 0; });
  info.even = all_scans(members, [](const ModelInfo& one) { return one.even; });
  for (const Member& member : members) {
    const ModelInfo& one = member.model->info();
    info.scatter += one.scatter;
    info.in_place = info.in_place || one.in_place;
    info.color_bits = std::max(info.color_bits, one.color_bits);
    info.harmonics_degree = std::max(info.harmonics_degree, one.harmonics_degree);
    info.ellipsoid_columns = std::max(info.ellipsoid_columns, one.ellipsoid_columns);
    info.source_names.insert(info.source_names.end(), one.source_names.begin(), one.source_names.end());
    merge_columns(member.model->scalars(), tables.scalars);
  }
  for (const ScalarColumn& column : tables.scalars) info.scalar_names.push_back(column.name);
  info.ranges = merged_ranges(members, tables.scalars);
  info.classes = merged_classes(members);
}

/// The numbers of items that the members state: blocks that are made when they are needed do not tell them.
void count_items(std::span<const Member> members, ModelInfo& info) {
  info.surfels = 0;
  for (KindCount& kind : info.kinds) kind.items = 0;
  for (const Member& member : members) {
    info.surfels += member.model->info().surfels;
    for (const KindCount& own : member.model->info().kinds) {
      std::ranges::find(info.kinds, own.kind, &KindCount::kind)->items += own.items;
    }
  }
}

Status check_members(std::span<const Member> members) {
  if (members.size() > kMaxMembers) {
    return fail(ErrorKind::kLimit, "at most " + std::to_string(kMaxMembers) + " models can be shown together");
  }
  std::set<std::string> names;
  for (const Member& member : members) {
    if (!names.insert(member.name).second) {
      return fail(ErrorKind::kInvalidInput, member.name + ": is named twice");
    }
    if (Status status = check_place(member); !status) return status;
  }
  return {};
}

void conform_colors(int from, int to, DecodedBlock& block) {
  if (to == 0) return;
  if (from == 0) {
    block.colors.assign(block.size(), glm::u16vec3(static_cast<uint16_t>(1 << (to - 1))));
  } else if (from != to) {
    for (glm::u16vec3& color : block.colors) color *= uint16_t{257};
  }
}

/// Codes of curvature that say nothing would make a block of discs one of curved surfels.
bool is_left_out(const std::string& name, const DecodedBlock& block) {
  if (!surfel::is_curvature_column(name)) return false;
  return std::ranges::find(block.scalars, name, &surfel::ScalarAttribute::name) == block.scalars.end();
}

}  // namespace

Status check_place(const Member& member) {
  if (member.places.empty()) return {};
  const auto& kinds = member.model->info().kinds;
  const bool surfels = std::ranges::all_of(kinds, [](const KindCount& kind) { return kind.kind == kSurfelKind; });
  const bool curved = surfel::has_curvature(member.model->info().scalar_names);
  if (surfels && !curved) return {};
  return fail(ErrorKind::kUnsupported, member.name +
                                           ": lies in another coordinate system than the first model, and only "
                                           "scans without curvature can be brought into that");
}

Result<JoinedTables> join_tables(std::vector<Member> members) {
  SURFCAST_EXPECTS(!members.empty());
  if (Status status = check_members(members); !status) return fail(status);
  JoinedTables tables;
  describe(members, tables);
  std::vector<std::vector<ldc::BlockEntry>> entries;
  for (const Member& member : members) {
    entries.push_back(entries_of(member, tables));
    add_sources(*member.model, tables);
  }
  tables.parts.members = std::move(members);
  add_blocks(entries, tables);
  count_blocks(tables.blocks, tables.info);
  if (tables.info.in_place) count_items(tables.parts.members, tables.info);
  return tables;
}

DecodedBlock conform(DecodedBlock block, int color_bits, int joined_color_bits, std::span<const ScalarColumn> scalars,
                     WantedScalars wanted) {
  conform_colors(color_bits, joined_color_bits, block);
  std::vector<surfel::ScalarAttribute> conformed;
  for (const ScalarColumn& column : scalars) {
    if (wanted != WantedScalars::kAll && is_left_out(column.name, block)) continue;
    const auto own = std::ranges::find(block.scalars, column.name, &surfel::ScalarAttribute::name);
    conformed.push_back({column.name, own == block.scalars.end()
                                          ? surfel::filling(column.name, column.type, block.size())
                                          : surfel::conformed(column.name, std::move(own->values), column.type)});
  }
  block.scalars = std::move(conformed);
  return block;
}

DecodedBlock placed(DecodedBlock block, const glm::dmat4x3& place) {
  if (block.size() == 0) return block;  // in a model whose blocks are made
  std::vector<glm::dvec3> positions;
  positions.reserve(block.size());
  geometry::Box bounds;
  for (size_t i = 0; i < block.size(); ++i) {
    positions.emplace_back(place * glm::dvec4(block.position(i), 1));
    bounds.include(positions.back());
  }
  block.grid = placed_grid(block.grid, bounds, place);
  block.origin = block.grid.index(bounds.min);
  const glm::dmat3 turn = turn_of(place);
  const auto factor = static_cast<float>(stretch(place));
  for (size_t i = 0; i < block.size(); ++i) {
    block.indices[i] = glm::ivec3(block.grid.index(positions[i]) - block.origin);
    block.normals[i] = glm::vec3(glm::normalize(turn * glm::dvec3(block.normals[i])));
    block.radii[i] *= factor;
  }
  return block;
}

}  // namespace surfcast::model
