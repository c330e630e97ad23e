#include "model/model_file.h"

#include <algorithm>
#include <atomic>
#include <iterator>
#include <utility>

#include "base/contract.h"
#include "base/file_source.h"
#include "model/block_cache.h"
#include "model/format.h"
#include "model/joined_model.h"
#include "model/model_counts.h"
#include "model/volume_tables.h"
#include "surfel/curvature.h"

namespace surfcast::model {

struct ModelFile::State {
  uint64_t id = 0;
  std::filesystem::path path;
  std::unique_ptr<const ByteSource> source;
  std::shared_ptr<BlockCache> cache;  ///< may be null
  ModelInfo info;
  Directory directory;
  std::vector<ScalarColumn> coarse_scalars;  ///< scalar attributes of coarse blocks
  ldc::BlockTree tree;
  std::vector<Member> members{};         ///< of a joined model, which has no source and no blocks in its directory
  std::vector<MemberOffsets> offsets{};  ///< of each member
};

namespace {

tl::unexpected<Error> fail_naming(const std::filesystem::path& path, const Error& error) {
  return fail(error.kind, path.string() + ": " + error.message);
}

ldc::BlockEntry make_entry(const BlockRecord& record, const surfel::Grid& grid) {
  ldc::BlockEntry entry;
  entry.parent = record.parent;
  entry.key = record.key;
  entry.bounds.include(grid.position(record.origin));
  entry.bounds.include(grid.position(record.origin + glm::i64vec3(record.extent)));
  entry.spacing = double{record.spacing};
  entry.max_radius = double{record.max_radius};
  entry.normals = record.normals;
  entry.surfels = record.surfels;
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

ByteRange range_of(const Directory& directory, size_t block) {
  SURFCAST_EXPECTS(block < directory.blocks.size());
  return {directory.blocks[block].offset, directory.blocks[block].bytes};
}

std::vector<ScalarColumn> coarse_columns(std::span<const ScalarColumn> scalars) {
  std::vector<ScalarColumn> coarse;
  std::copy_if(scalars.begin(), scalars.end(), std::back_inserter(coarse),
               [](const ScalarColumn& scalar) { return scalar.coarse; });
  return coarse;
}

uint64_t next_id() {
  static std::atomic<uint64_t> last{0};
  return ++last;
}

Result<std::vector<std::byte>> load(const ByteSource& source, uint64_t offset, uint64_t size) {
  std::vector<std::byte> bytes(size);
  if (Status status = source.read(offset, bytes); !status) return fail(std::move(status.error()));
  return bytes;
}

Result<ModelHeader> load_header(const ByteSource& source) {
  const Result<std::vector<std::byte>> head = load(source, 0, std::min<uint64_t>(source.size(), kHeaderBytes));
  if (!head) return fail(head.error());
  return read_header(*head, source.size());
}

Result<Directory> load_directory(const ByteSource& source, const ModelHeader& header) {
  const Result<std::vector<std::byte>> bytes = load(source, header.directory_offset, header.directory_bytes);
  if (!bytes) return fail(bytes.error());
  return read_directory(*bytes, header);
}

ModelInfo make_info(const ModelHeader& header, const Directory& directory, std::span<const ldc::BlockEntry> entries) {
  ModelInfo info;
  info.oriented = header.oriented;
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
  if (!file) return fail(std::move(file.error()));
  return open(std::make_unique<FileSource>(std::move(*file), path));
}

Result<ModelFile> ModelFile::open(std::unique_ptr<const ByteSource> source, std::shared_ptr<BlockCache> cache) {
  const std::filesystem::path path = source->name();
  const Result<ModelHeader> header = load_header(*source);
  if (!header) return fail_naming(path, header.error());
  Result<Directory> directory = load_directory(*source, *header);
  if (!directory) return fail_naming(path, directory.error());

  std::vector<ldc::BlockEntry> entries = make_entries(*directory);
  if (!valid_tree(entries)) {
    return fail_naming(path, {ErrorKind::kInvalidInput, "the blocks of the model make no tree"});
  }
  set_levels(entries);
  if (!valid_pyramids(*directory, entries)) {
    return fail_naming(path, {ErrorKind::kInvalidInput, "the bricks of the model make no pyramid"});
  }
  ModelInfo info = make_info(*header, *directory, entries);
  std::vector<ScalarColumn> coarse_scalars = coarse_columns(directory->scalars);
  return ModelFile(std::make_unique<State>(State{next_id(), path, std::move(source), std::move(cache), std::move(info),
                                                 std::move(*directory), std::move(coarse_scalars),
                                                 ldc::BlockTree(std::move(entries))}));
}

Result<ModelFile> ModelFile::join(std::vector<Member> members) {
  Result<JoinedTables> tables = join_tables(members);
  if (!tables) return fail(std::move(tables.error()));
  std::string path;
  for (const Member& member : members) path += (path.empty() ? "" : "+") + member.name;
  Directory directory;
  directory.scalars = std::move(tables->scalars);
  directory.volumes = std::move(tables->volumes);
  directory.ellipsoids = std::move(tables->ellipsoids);
  std::vector<ScalarColumn> coarse_scalars = coarse_columns(directory.scalars);
  return ModelFile(std::make_unique<State>(
      State{next_id(), path, nullptr, nullptr, std::move(tables->info), std::move(directory), std::move(coarse_scalars),
            ldc::BlockTree(std::move(tables->blocks)), std::move(members), std::move(tables->offsets)}));
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
  return state_->directory.volumes;
}

std::span<const EllipsoidSource> ModelFile::ellipsoid_sources() const {
  return state_->directory.ellipsoids;
}

std::span<const ScalarColumn> ModelFile::scalars() const {
  return state_->directory.scalars;
}

std::span<const Member> ModelFile::members() const {
  return state_->members;
}

Part ModelFile::part(uint32_t block) const {
  SURFCAST_EXPECTS(block < blocks().size());
  if (state_->members.empty()) return {*this, block};
  const auto after = std::ranges::upper_bound(state_->offsets, block, {}, &MemberOffsets::block);
  const auto member = static_cast<uint32_t>(after - state_->offsets.begin()) - 1;
  const MemberOffsets& offsets = state_->offsets[member];
  return {*state_->members[member].model, block - offsets.block, member, offsets.volume, offsets.ellipsoids};
}

BrickRecord ModelFile::brick(size_t block) const {
  SURFCAST_EXPECTS(block < blocks().size() && state_->info.kinds[blocks()[block].kind].kind == kGridKind);
  if (!state_->members.empty()) {
    const Part own = part(static_cast<uint32_t>(block));
    BrickRecord brick = own.model.brick(own.block);
    brick.volume += own.first_volume;
    return brick;
  }
  return state_->directory.bricks[state_->directory.blocks[block].brick];
}

const std::filesystem::path& ModelFile::path() const {
  return state_->path;
}

const ByteSource& ModelFile::source() const {
  SURFCAST_EXPECTS(state_->members.empty());
  return *state_->source;
}

void ModelFile::prefetch(std::span<const uint32_t> blocks) const {
  if (!state_->members.empty()) {
    std::vector<std::vector<uint32_t>> own(state_->members.size());
    for (const uint32_t block : blocks) {
      const Part of = part(block);
      own[of.member].push_back(of.block);
    }
    for (size_t i = 0; i < own.size(); ++i) state_->members[i].model->prefetch(own[i]);
    return;
  }
  std::vector<ByteRange> ranges;
  ranges.reserve(blocks.size());
  for (const uint32_t block : blocks) {
    const ByteRange range = range_of(state_->directory, block);
    const uint64_t checksum = state_->directory.blocks[block].checksum;
    if (!state_->cache || !state_->cache->contains(checksum, range.size)) ranges.push_back(range);
  }
  state_->source->prefetch(ranges);
}

void ModelFile::forget(size_t block) const {
  if (!state_->members.empty()) {
    const Part own = part(static_cast<uint32_t>(block));
    return own.model.forget(own.block);
  }
  state_->source->forget(range_of(state_->directory, block));
}

namespace {

/// The number of scalar attributes to decode, counted from the first. Curvature is drawn as the normal is, whatever is
/// asked for.
size_t count_of(WantedScalars wanted, std::span<const ScalarColumn> scalars) {
  if (wanted == WantedScalars::kAll) return scalars.size();
  size_t count = 0;
  for (size_t i = 0; i < scalars.size(); ++i) {
    if (surfel::is_curvature_column(scalars[i].name) || (wanted == WantedScalars::kDrawn && scalars[i].coarse))
      count = i + 1;
  }
  return count;
}

/// Memory for the block that this thread reads. It is used again, so that decoding takes none anew.
std::span<std::byte> buffer_of_thread(size_t size) {
  constexpr size_t kKept = size_t{8} << 20;  // more than the blocks of any model that was built
  thread_local std::vector<std::byte> buffer;
  if (buffer.size() > kKept && size <= kKept) buffer = {};
  if (buffer.size() < size) buffer.resize(size);
  return std::span(buffer).first(size);
}

}  // namespace

Error ModelFile::named(size_t block, const Error& error) const {
  if (!state_->members.empty()) {
    const Part own = part(static_cast<uint32_t>(block));
    return own.model.named(own.block, error);
  }
  return {error.kind, state_->path.string() + ": block " + std::to_string(block) + ": " + error.message};
}

Result<StoredBlock> ModelFile::stored(size_t block) const {
  if (!state_->members.empty()) {
    const Part own = part(static_cast<uint32_t>(block));
    return own.model.stored(own.block);
  }
  SURFCAST_EXPECTS(block < state_->directory.blocks.size());
  const BlockRecord& record = state_->directory.blocks[block];
  // What is checked is what is decoded: the file may be overwritten at any time.
  const std::span<std::byte> bytes = buffer_of_thread(record.bytes);
  const StoredBlock stored_block{bytes, state_->directory.grids[record.grid], record.origin, record.extent,
                                 record.surfels};
  if (state_->cache && state_->cache->read(record.checksum, bytes)) return stored_block;
  if (const Status read = state_->source->read(record.offset, bytes); !read) return fail(named(block, read.error()));
  if (checksum_of(bytes) != record.checksum) return fail(named(block, {ErrorKind::kInvalidInput, "damaged"}));
  if (state_->cache) state_->cache->write(record.checksum, bytes);
  return stored_block;
}

Result<DecodedBlock> ModelFile::decode(size_t block, WantedScalars scalars) const {
  const std::span<const ScalarColumn> columns =
      blocks()[block].level == 0 ? state_->directory.scalars : state_->coarse_scalars;
  const size_t wanted = count_of(scalars, columns);
  if (!state_->members.empty()) {
    const Part own = part(static_cast<uint32_t>(block));
    Result<DecodedBlock> decoded = own.model.decode(own.block, scalars);
    if (!decoded) return decoded;
    const std::vector<glm::dmat4x3>& places = state_->members[own.member].places;
    if (!places.empty()) decoded = placed(std::move(*decoded), places[own.block]);
    return conform(std::move(*decoded), own.model.info().color_bits, state_->info, columns.first(wanted), scalars);
  }
  const Result<StoredBlock> stored_block = stored(block);
  if (!stored_block) return fail(stored_block.error());
  if (state_->info.kinds[blocks()[block].kind].kind != kSurfelKind) {
    return fail(named(block, {ErrorKind::kUnsupported, "has no surfels"}));
  }
  BlockShape shape;
  shape.grid = stored_block->grid;
  shape.origin = stored_block->origin;
  shape.extent = stored_block->extent;
  shape.surfels = stored_block->items;
  shape.scatter = state_->directory.blocks[block].scatter;
  shape.color_bits = state_->info.color_bits;
  shape.scalars = columns;
  Result<DecodedBlock> decoded = decode_block(stored_block->bytes, shape, wanted);
  if (!decoded) return fail(named(block, decoded.error()));
  return decoded;
}

}  // namespace surfcast::model
