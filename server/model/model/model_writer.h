#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "base/result.h"
#include "ldc/octree_key.h"
#include "model/block_decoder.h"
#include "model/block_encoder.h"
#include "model/ellipsoid_source.h"
#include "model/georeference.h"
#include "surfel/surfel_cloud.h"

namespace surfcast::model {

/// Properties that all blocks of a model share.
struct ModelSchema {
  bool oriented = false;  ///< see SurfelCloud::oriented
  bool z_up = true;       ///< see SurfelCloud::z_up
  int color_bits = 0;     ///< 8 or 16; 0 without colour
  std::vector<std::string> source_names;
  std::vector<ScalarColumn> scalars;
  bool upside_down = false;  ///< see ModelInfo::upside_down
  int harmonics_degree = 0;  ///< see ModelInfo::harmonics_degree
  bool even = false;         ///< see ModelInfo::even
};

/// The schema of a model made from this cloud.
ModelSchema schema_of(const surfel::SurfelCloud& cloud);

struct WriteReport {
  uint64_t surfels = 0;  ///< of the source
  uint64_t blocks = 0;   ///< of all levels
  uint64_t bytes = 0;
};

/// Writes a model file block by block, children before their parents. Only the table of blocks stays in memory. The
/// target file appears only when it is complete. The order and the content of the calls determine every byte of the
/// file.
class ModelWriter {
 public:
  static Result<ModelWriter> create(const std::filesystem::path& target, ModelSchema schema);

  ModelWriter(ModelWriter&&) noexcept;
  ModelWriter& operator=(ModelWriter&&) noexcept;
  ~ModelWriter();

  /// Appends a block and returns its number. `children` are the numbers of previously added blocks that it represents,
  /// each of the same kind and the child of one block only. A block of source surfels has no children.
  Result<uint32_t> add(const EncodedBlock& block, const ldc::OctreeKey& key, std::span<const uint32_t> children);

  /// Adds the properties of blocks of another kind: their sources and harmonics. Colours, attributes and the vertical
  /// axis stay those of the schema that came first.
  void add_schema(const ModelSchema& schema);

  /// Adds statistics of source surfels whose blocks are added without them.
  void add_statistics(const AttributeStatistics& statistics);

  /// The volumes whose bricks are blocks of the file. Call before finish().
  void set_volumes(std::vector<Volume> volumes);

  /// The sources whose ellipsoids are blocks of the file. Call before finish().
  void set_ellipsoid_sources(std::vector<EllipsoidSource> sources);

  /// Where on the earth the model lies, if that is known. Call before finish().
  void set_georeference(Georeference georeference);

  /// Writes the tables and moves the file to its target. Fails if no block was added.
  Result<WriteReport> finish();

 private:
  struct State;
  explicit ModelWriter(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace surfcast::model
