#include "model/model_file.h"

#include <algorithm>
#include <atomic>
#include <utility>

#include "base/contract.h"
#include "base/file_source.h"
#include "model/block_cache.h"
#include "model/block_provider.h"
#include "model/format.h"
#include "model/joined_blocks.h"
#include "model/joined_model.h"
#include "model/kind_tables.h"
#include "model/model_counts.h"
#include "model/stored_blocks.h"

namespace surfcast::model {

struct ModelFile::State {
  uint64_t id = 0;
  std::filesystem::path path;
  std::unique_ptr<const BlockProvider> provider;
  ModelInfo info;
  std::shared_ptr<const Directory> directory;
  ldc::BlockTree tree;
  /// Of a joined model, which has no source and no blocks in its directory; otherwise null.
  std::shared_ptr<const JoinedParts> parts{};
};

namespace {

ldc::BlockEntry make_entry(const BlockRecord& record, const surfel::Grid& grid) {
  ldc::BlockEntry entry;
  entry.parent = record.parent;
  entry.key = record.key;
  entry.bounds.include(grid.position(record.origin));
  entry.bounds.include(grid.position(record.origin + glm::i64vec3(record.extent)));
  entry.spacing = double{record.spacing};
  entry.max_radius = double{record.max_radius};
  entry.normals = record.normals;
  entry.items = record.items;
  entry.offset = record.offset;
  entry.bytes = record.bytes;
  entry.checksum = record.checksum;
  entry.kind = record.kind;
  return entry;
}

/// True if the blocks form trees of nested cells, each tree of one kind. A block must be deeper than its parent unless
/// it is a leaf, which bounds the paths through a hostile tree by the depth of the octree.
bool valid_tree(std::span<const ldc::BlockEntry> entries) {
  if (!ldc::BlockTree::is_tree(entries)) return false;
  return std::all_of(entries.begin(), entries.end(), [&](const ldc::BlockEntry& entry) {
    if (entry.parent == ldc::BlockEntry::kNoParent) return true;
    const ldc::BlockEntry& parent = entries[entry.parent];
    const bool below_its_parent =
        parent.parent == ldc::BlockEntry::kNoParent || parent.key.depth > entries[parent.parent].key.depth;
    return ldc::contains(parent.key, entry.key) && below_its_parent && entry.kind == parent.kind;
  });
}

/// Sets the level of each block: one more than the highest level of its children, which come after it.
void set_levels(std::span<ldc::BlockEntry> entries) {
  for (size_t i = entries.size(); i-- > 0;) {
    if (entries[i].parent == ldc::BlockEntry::kNoParent) continue;
    ldc::BlockEntry& parent = entries[entries[i].parent];
    parent.level = std::max(parent.level, entries[i].level + 1);
  }
}

/// True if the bricks of each volume have the levels of their blocks and lie where their parents are.
bool valid_pyramids(const Directory& directory, std::span<const ldc::BlockEntry> entries) {
  for (size_t i = 0; i < entries.size(); ++i) {
    const BlockRecord& block = directory.blocks[i];
    if (directory.kinds[block.kind] != kGridKind) continue;
    const uint32_t level = directory.bricks[block.brick].level;
    if (level != static_cast<uint32_t>(entries[i].level) || !is_within_pyramid(directory, block)) return false;
  }
  return true;
}

std::vector<ldc::BlockEntry> make_entries(const Directory& directory) {
  std::vector<ldc::BlockEntry> entries;
  entries.reserve(directory.blocks.size());
  for (const BlockRecord& record : directory.blocks) {
    entries.push_back(make_entry(record, directory.grids[record.grid]));
  }
  return entries;
}

uint64_t next_id() {
  static std::atomic<uint64_t> last{0};
  return ++last;
}

Result<std::vector<std::byte>> load(const ByteSource& source, uint64_t offset, uint64_t size) {
  std::vector<std::byte> bytes(size);
  if (Status status = source.read(offset, bytes); !status) return fail(status);
  return bytes;
}

Result<ModelHeader> load_header(const ByteSource& source) {
  const Result<std::vector<std::byte>> head = load(source, 0, std::min<uint64_t>(source.size(), kHeaderBytes));
  if (!head) return fail(head);
  return read_header(*head, source.size());
}

Result<Directory> load_directory(const ByteSource& source, const ModelHeader& header) {
  const Result<std::vector<std::byte>> bytes = load(source, header.directory_offset, header.directory_bytes);
  if (!bytes) return fail(bytes);
  return read_directory(*bytes, header);
}

ModelInfo make_info(const ModelHeader& header, const Directory& directory, std::span<const ldc::BlockEntry> entries) {
  ModelInfo info;
  info.oriented = info.partly_oriented = header.oriented;
  info.z_up = header.z_up;
  info.color_bits = header.color_bits;
  info.upside_down = header.upside_down;
  info.harmonics_degree = header.harmonics_degree;
  info.even = header.even;
  for (const ScalarColumn& scalar : directory.scalars) info.scalar_names.push_back(scalar.name);
  info.source_names = directory.source_names;
  info.ranges = directory.ranges;
  info.classes = directory.classes;
  for (const EllipsoidSource& source : directory.ellipsoids) {
    info.ellipsoid_columns = std::max(info.ellipsoid_columns, source.attributes.size() - kDerivedAttributes);
  }
  for (const std::string& kind : directory.kinds) info.kinds.push_back({kind, 0, 0});
  for (size_t i = 0; i < entries.size(); ++i) {
    if (entries[i].level == 0) info.scatter += directory.blocks[i].scatter;
  }
  count_blocks(entries, info);
  return info;
}

}  // namespace

ModelFile::ModelFile(std::unique_ptr<State> state) : state_(std::move(state)) {}
ModelFile::ModelFile(ModelFile&&) noexcept = default;
ModelFile& ModelFile::operator=(ModelFile&&) noexcept = default;
ModelFile::~ModelFile() = default;

Result<ModelFile> ModelFile::open(const std::filesystem::path& path) {
  Result<PositionedFile> file = PositionedFile::open(path);
  if (!file) return fail(file);
  return open(std::make_unique<FileSource>(std::move(*file), path));
}

Result<ModelFile> ModelFile::open(std::unique_ptr<const ByteSource> source, std::shared_ptr<BlockCache> cache) {
  const std::filesystem::path path = source->name();
  const Result<ModelHeader> header = load_header(*source);
  if (!header) return fail_about(path.string(), header);
  Result<Directory> directory = load_directory(*source, *header);
  if (!directory) return fail_about(path.string(), directory);

  std::vector<ldc::BlockEntry> entries = make_entries(*directory);
  if (!valid_tree(entries)) {
    return fail_about(path.string(), Error{ErrorKind::kInvalidInput, "the blocks of the model make no tree"});
  }
  set_levels(entries);
  if (!valid_pyramids(*directory, entries)) {
    return fail_about(path.string(), Error{ErrorKind::kInvalidInput, "the bricks of the model make no pyramid"});
  }
  ModelInfo info = make_info(*header, *directory, entries);
  std::vector<bool> coarse(entries.size());
  for (size_t i = 0; i < entries.size(); ++i) coarse[i] = entries[i].level > 0;
  auto tables = std::make_shared<const Directory>(std::move(*directory));
  auto provider = std::make_unique<const StoredBlocks>(std::move(source), std::move(cache), tables, info.color_bits,
                                                       std::move(coarse));
  return ModelFile(std::make_unique<State>(State{next_id(), path, std::move(provider), std::move(info),
                                                 std::move(tables), ldc::BlockTree(std::move(entries))}));
}

ModelFile ModelFile::of_blocks(const std::filesystem::path& path, ModelInfo info, std::vector<ldc::BlockEntry> entries,
                               std::unique_ptr<const BlockProvider> provider) {
  set_levels(entries);
  return ModelFile(
      std::make_unique<State>(State{next_id(), path, std::move(provider), std::move(info),
                                    std::make_shared<const Directory>(), ldc::BlockTree(std::move(entries))}));
}

Result<ModelFile> ModelFile::join(std::vector<Member> members) {
  Result<JoinedTables> tables = join_tables(std::move(members));
  if (!tables) return fail(tables);
  auto parts = std::make_shared<const JoinedParts>(std::move(tables->parts));
  std::string path;
  for (const Member& member : parts->members) path += (path.empty() ? "" : "+") + member.name;
  auto directory = std::make_shared<Directory>();
  directory->volumes = std::move(tables->volumes);
  directory->ellipsoids = std::move(tables->ellipsoids);
  auto provider = std::make_unique<const JoinedBlocks>(parts, tables->info, tables->scalars);
  return ModelFile(
      std::make_unique<State>(State{next_id(), path, std::move(provider), std::move(tables->info), std::move(directory),
                                    ldc::BlockTree(std::move(tables->blocks)), std::move(parts)}));
}

uint64_t ModelFile::id() const {
  return state_->id;
}

const ModelInfo& ModelFile::info() const {
  return state_->info;
}

const ldc::BlockTree& ModelFile::tree() const {
  return state_->tree;
}

std::span<const Volume> ModelFile::volumes() const {
  return state_->directory->volumes;
}

std::span<const EllipsoidSource> ModelFile::ellipsoid_sources() const {
  return state_->directory->ellipsoids;
}

std::span<const ScalarColumn> ModelFile::scalars() const {
  return state_->provider->scalars();
}

std::span<const Member> ModelFile::members() const {
  if (!state_->parts) return {};
  return state_->parts->members;
}

Part ModelFile::part(uint32_t block) const {
  SURFCAST_EXPECTS(block < blocks().size());
  if (!state_->parts) return {*this, block};
  const BlockOrigin& origin = state_->parts->origins[block];
  if (origin.member == BlockOrigin::kShared) return {*this, block};
  const MemberOffsets& first = state_->parts->offsets[origin.member];
  return {*state_->parts->members[origin.member].model, origin.index, origin.member, first.volume, first.ellipsoids};
}

std::bitset<kMaxMembers> ModelFile::members_of(uint32_t block) const {
  SURFCAST_EXPECTS(block < blocks().size());
  if (!state_->parts) return {};
  const BlockOrigin& origin = state_->parts->origins[block];
  if (origin.member == BlockOrigin::kShared) return state_->parts->shared[origin.index].members;
  return std::bitset<kMaxMembers>().set(origin.member);
}

BrickRecord ModelFile::brick(size_t block) const {
  SURFCAST_EXPECTS(block < blocks().size() && state_->info.kinds[blocks()[block].kind].kind == kGridKind);
  if (state_->parts) {
    const Part own = part(static_cast<uint32_t>(block));
    BrickRecord brick = own.model.brick(own.block);
    brick.volume += own.first_volume;
    return brick;
  }
  return state_->directory->bricks[state_->directory->blocks[block].brick];
}

const std::filesystem::path& ModelFile::path() const {
  return state_->path;
}

const ByteSource& ModelFile::source() const {
  return state_->provider->source();
}

void ModelFile::prefetch(std::span<const uint32_t> blocks) const {
  state_->provider->prefetch(blocks);
}

void ModelFile::forget(size_t block) const {
  state_->provider->forget(block);
}

uint64_t ModelFile::unit_of(uint32_t block) const {
  return state_->provider->unit_of(block);
}

Result<Georeference> ModelFile::georeference() const {
  return state_->provider->georeference();
}

Error ModelFile::named(size_t block, const Error& error) const {
  const Part own = part(static_cast<uint32_t>(block));
  if (&own.model != this) return own.model.named(own.block, error);
  return {error.kind, state_->path.string() + ": block " + std::to_string(block) + ": " + error.message};
}

Result<StoredBlock> ModelFile::stored(size_t block) const {
  Result<StoredBlock> stored = state_->provider->stored(block);
  if (state_->parts) return stored;  // its member has named an error
  return stored.map_error([&](const Error& error) { return named(block, error); });
}

Result<DecodedBlock> ModelFile::decode(size_t block, WantedScalars scalars) const {
  Result<DecodedBlock> decoded = state_->provider->decode(block, scalars);
  if (state_->parts) return decoded;
  if (decoded && state_->info.oriented) decoded->oriented = true;
  return decoded.map_error([&](const Error& error) { return named(block, error); });
}

}  // namespace surfcast::model
