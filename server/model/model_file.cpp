#include "model/model_file.h"

#include <atomic>
#include <utility>

#include "base/contract.h"
#include "base/mapped_file.h"
#include "model/format.h"

namespace surfcast {

struct ModelFile::State {
  uint64_t id = 0;
  std::filesystem::path path;
  MappedFile file;
  ModelInfo info;
  Directory directory;
  BlockTree tree;
};

namespace {

tl::unexpected<Error> fail_naming(const std::filesystem::path& path, const Error& error) {
  return fail(error.kind, path.string() + ": " + error.message);
}

BlockEntry make_entry(const BlockRecord& record, const Grid& grid) {
  BlockEntry entry;
  entry.level = record.level;
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
  return entry;
}

uint64_t next_id() {
  static std::atomic<uint64_t> last{0};
  return ++last;
}

ModelInfo make_info(const ModelHeader& header, const Directory& directory, std::span<const BlockEntry> entries) {
  ModelInfo info;
  info.oriented = header.oriented;
  info.z_up = header.z_up;
  info.color_bits = header.color_bits;
  info.scalar_names = directory.scalar_names;
  info.source_names = directory.source_names;
  for (const BlockEntry& entry : entries) {
    info.bounds.include(entry.bounds);
    info.surfels += entry.surfels;
  }
  return info;
}

}  // namespace

ModelFile::ModelFile(std::unique_ptr<State> state) : state_(std::move(state)) {}
ModelFile::ModelFile(ModelFile&&) noexcept = default;
ModelFile& ModelFile::operator=(ModelFile&&) noexcept = default;
ModelFile::~ModelFile() = default;

Result<ModelFile> ModelFile::open(const std::filesystem::path& path) {
  Result<MappedFile> file = MappedFile::open(path);
  if (!file) return fail(std::move(file.error()));
  const Result<ModelHeader> header = read_header(file->bytes());
  if (!header) return fail_naming(path, header.error());
  Result<Directory> directory = read_directory(file->bytes().subspan(header->directory_offset), *header);
  if (!directory) return fail_naming(path, directory.error());

  std::vector<BlockEntry> entries;
  entries.reserve(directory->blocks.size());
  for (const BlockRecord& record : directory->blocks) {
    entries.push_back(make_entry(record, directory->grids[record.grid]));
  }
  ModelInfo info = make_info(*header, *directory, entries);
  return ModelFile(std::make_unique<State>(
      State{next_id(), path, std::move(*file), std::move(info), std::move(*directory), BlockTree(std::move(entries))}));
}

uint64_t ModelFile::id() const {
  return state_->id;
}

const ModelInfo& ModelFile::info() const {
  return state_->info;
}

const BlockTree& ModelFile::tree() const {
  return state_->tree;
}

const std::filesystem::path& ModelFile::path() const {
  return state_->path;
}

Result<DecodedBlock> ModelFile::decode(size_t block) const {
  SURFCAST_EXPECTS(block < state_->directory.blocks.size());
  const auto named = [&](const Error& error) {
    return fail(error.kind, state_->path.string() + ": block " + std::to_string(block) + ": " + error.message);
  };
  const BlockRecord& record = state_->directory.blocks[block];
  const std::span<const std::byte> bytes = state_->file.bytes().subspan(record.offset, record.bytes);
  if (checksum_of(bytes) != record.checksum) return named({ErrorKind::kInvalidInput, "damaged"});
  BlockShape shape;
  shape.grid = state_->directory.grids[record.grid];
  shape.origin = record.origin;
  shape.extent = record.extent;
  shape.surfels = record.surfels;
  shape.color_bits = state_->info.color_bits;
  shape.scalar_names = state_->directory.scalar_names;
  shape.scalar_types = state_->directory.scalar_types;
  Result<DecodedBlock> decoded = decode_block(bytes, shape);
  if (!decoded) return named(decoded.error());
  return decoded;
}

}  // namespace surfcast
