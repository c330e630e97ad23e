#include "model/model_writer.h"

#include <algorithm>
#include <utility>

#include "base/atomic_file.h"
#include "base/contract.h"
#include "ldc/coarse_scalars.h"
#include "model/format.h"

namespace surfcast::model {

struct ModelWriter::State {
  State(AtomicFile output, ModelSchema model_schema) : file(std::move(output)), schema(std::move(model_schema)) {}

  AtomicFile file;
  ModelSchema schema;
  std::vector<surfel::Grid> grids;
  std::vector<std::string> kinds;
  std::vector<Volume> volumes;
  std::vector<BrickRecord> bricks;
  std::vector<EllipsoidSource> ellipsoids;
  std::vector<BlockRecord> records;             ///< in the order of the file; parents are indices into this list
  std::vector<std::vector<uint32_t>> children;  ///< of each record
  AttributeStatistics statistics;
  Georeference georeference;
};

namespace {

/// Index of a value in a table. Appends the value if the table lacks it.
template <typename T>
uint32_t index_of(const T& value, std::vector<T>& table) {
  const auto found = std::find(table.begin(), table.end(), value);
  const auto index = static_cast<uint32_t>(found - table.begin());
  if (found == table.end()) table.push_back(value);
  return index;
}

BlockRecord make_record(const EncodedBlock& block, const ldc::OctreeKey& key) {
  BlockRecord record;
  record.key = key;
  record.origin = block.origin;
  record.extent = block.extent;
  record.items = block.items;
  record.scatter = block.scatter;
  record.spacing = block.spacing;
  record.max_radius = block.max_radius;
  record.normals = block.normals;
  record.bytes = static_cast<uint32_t>(block.bytes.size());
  record.checksum = checksum_of(block.bytes);
  return record;
}

/// The records level by level from the roots down: parents before children, siblings contiguous.
std::vector<BlockRecord> in_tree_order(std::span<const BlockRecord> records,
                                       std::span<const std::vector<uint32_t>> children) {
  std::vector<uint32_t> order;
  order.reserve(records.size());
  std::vector<BlockRecord> sorted;
  sorted.reserve(records.size());
  for (uint32_t i = 0; i < records.size(); ++i) {
    if (records[i].parent != ldc::BlockEntry::kNoParent) continue;
    order.push_back(i);
    sorted.push_back(records[i]);
  }
  for (uint32_t parent = 0; parent < order.size(); ++parent) {
    for (const uint32_t child : children[order[parent]]) {
      order.push_back(child);
      sorted.push_back(records[child]);
      sorted.back().parent = parent;
    }
  }
  SURFCAST_EXPECTS(sorted.size() == records.size());
  return sorted;
}

ModelHeader make_header(const ModelSchema& schema, uint32_t version, std::span<const std::byte> tables,
                        uint64_t offset) {
  ModelHeader header;
  header.version = version;
  header.oriented = schema.oriented;
  header.z_up = schema.z_up;
  header.color_bits = schema.color_bits;
  header.upside_down = schema.upside_down;
  header.harmonics_degree = schema.harmonics_degree;
  header.even = schema.even;
  header.file_bytes = offset + tables.size();
  header.directory_offset = offset;
  header.directory_bytes = tables.size();
  header.directory_checksum = checksum_of(tables);
  return header;
}

}  // namespace

ModelSchema schema_of(const surfel::SurfelCloud& cloud) {
  ModelSchema schema{cloud.oriented, cloud.z_up, cloud.colors ? cloud.colors->bits : 0, {}, {}, false, 0};
  for (const surfel::SourceRange& source : cloud.sources) schema.source_names.push_back(source.name);
  for (const surfel::ScalarAttribute& scalar : cloud.scalars) {
    schema.scalars.push_back(
        {scalar.name, static_cast<ScalarCode>(scalar.values.index()), ldc::is_coarse_scalar(scalar.name)});
  }
  return schema;
}

ModelWriter::ModelWriter(std::unique_ptr<State> state) : state_(std::move(state)) {}
ModelWriter::ModelWriter(ModelWriter&&) noexcept = default;
ModelWriter& ModelWriter::operator=(ModelWriter&&) noexcept = default;
ModelWriter::~ModelWriter() = default;

Result<ModelWriter> ModelWriter::create(const std::filesystem::path& target, ModelSchema schema) {
  if (schema.scalars.size() > kMaxScalars) {
    return fail(ErrorKind::kLimit, target.string() + ": more attributes than a model holds");
  }
  Result<AtomicFile> file = AtomicFile::create(target);
  if (!file) return fail(file);
  if (Status status = file->append(write_header({})); !status) return fail(status);
  return ModelWriter(std::make_unique<State>(std::move(*file), std::move(schema)));
}

Result<uint32_t> ModelWriter::add(const EncodedBlock& block, const ldc::OctreeKey& key,
                                  std::span<const uint32_t> children) {
  SURFCAST_EXPECTS(block.items >= 1 && block.items <= kMaxBlockSurfels && !block.kind.empty());
  SURFCAST_EXPECTS(block.brick.has_value() == (block.kind == kGridKind));
  const auto number = static_cast<uint32_t>(state_->records.size());
  BlockRecord record = make_record(block, key);
  record.offset = state_->file.position();
  record.grid = index_of(block.grid, state_->grids);
  record.kind = static_cast<uint8_t>(index_of(block.kind, state_->kinds));
  record.brick = static_cast<uint32_t>(state_->bricks.size());
  if (block.brick) state_->bricks.push_back(*block.brick);
  if (Status status = state_->file.append(block.bytes); !status) return fail(status);
  for (const uint32_t child : children) {
    SURFCAST_EXPECTS(child < number && state_->records[child].parent == ldc::BlockEntry::kNoParent);
    SURFCAST_EXPECTS(state_->records[child].kind == record.kind);
    state_->records[child].parent = number;
  }
  state_->records.push_back(record);
  state_->statistics.add(block.statistics);
  state_->children.emplace_back(children.begin(), children.end());
  return number;
}

void ModelWriter::add_schema(const ModelSchema& schema) {
  ModelSchema& own = state_->schema;
  own.source_names.insert(own.source_names.end(), schema.source_names.begin(), schema.source_names.end());
  own.harmonics_degree = std::max(own.harmonics_degree, schema.harmonics_degree);
}

void ModelWriter::add_statistics(const AttributeStatistics& statistics) {
  state_->statistics.add(statistics);
}

void ModelWriter::set_volumes(std::vector<Volume> volumes) {
  state_->volumes = std::move(volumes);
}

void ModelWriter::set_ellipsoid_sources(std::vector<EllipsoidSource> sources) {
  state_->ellipsoids = std::move(sources);
}

void ModelWriter::set_georeference(Georeference georeference) {
  state_->georeference = std::move(georeference);
}

Result<WriteReport> ModelWriter::finish() {
  AtomicFile& file = state_->file;
  if (state_->records.empty()) return fail(ErrorKind::kInvalidInput, "no surfels to write");
  Directory directory{state_->schema.source_names,
                      state_->schema.scalars,
                      state_->grids,
                      in_tree_order(state_->records, state_->children),
                      {},
                      {},
                      state_->kinds,
                      state_->volumes,
                      state_->bricks,
                      state_->ellipsoids};
  std::vector<std::string> names;
  for (const ScalarColumn& scalar : state_->schema.scalars) names.push_back(scalar.name);
  directory.ranges = state_->statistics.ranges(names);
  directory.classes = state_->statistics.classes();
  const std::vector<std::byte> tables = write_directory(directory);
  const uint64_t end_of_blocks = file.position();
  Status status;
  if (state_->georeference.known()) status = file.append(write_georeference(state_->georeference));
  ModelHeader facts = make_header(state_->schema, directory.version(), tables, file.position());
  if (state_->georeference.known()) facts.georeference_offset = end_of_blocks;
  const std::vector<std::byte> header = write_header(facts);
  if (status) status = file.append(tables);
  if (status) status = file.overwrite(0, header);
  if (status) status = file.commit();
  if (!status) return fail(status);
  WriteReport report{0, directory.blocks.size(), file.position()};
  for (size_t i = 0; i < state_->records.size(); ++i) {
    const BlockRecord& record = state_->records[i];
    if (state_->children[i].empty() && state_->kinds[record.kind] == kSurfelKind) report.surfels += record.items;
  }
  return report;
}

}  // namespace surfcast::model
