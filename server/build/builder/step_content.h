#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "base/result.h"
#include "builder/make_part.h"
#include "builder/part_blocks.h"
#include "builder/work_file.h"
#include "ldc/subtree.h"
#include "model/block_encoder.h"
#include "model/statistics.h"
#include "scan/scan_schema.h"

namespace surfcast::builder {

/// What a part tells about the scene.
struct PartEvidence {
  estimation::PartSigns signs;
  std::vector<estimation::RadiusComparison> radii;  ///< of each input
  std::vector<estimation::SurfaceSample> samples;
  estimation::SurfelReport report;
};

/// Writes a part after its first phase. Its arrays are only read.
Status write_part(WorkFileWriter& file, MadePart& part);
Result<PartEvidence> read_evidence(const WorkFile& file);
/// The surfels of a part. Empty: signs, report, samples and comparisons.
Result<MadePart> read_surfels(const WorkFile& file, const scan::ScanSchema& schema, std::span<const InputName> inputs);

/// What is decided for all parts.
struct SceneResult {
  SceneDecisions decisions;
  estimation::SurfelReport report;  ///< of all parts, without what was dropped when points were read
};

Status write_scene(WorkFileWriter& file, const SceneResult& scene,
                   const std::vector<estimation::SurfaceSample>& samples);
Result<SceneResult> read_scene(const WorkFile& file);
/// The samples of the surfaces of all parts.
Result<std::vector<estimation::SurfaceSample>> read_samples(const WorkFile& file);

/// Encodes and writes the blocks of a part.
Status write_part_blocks(WorkFileWriter& file, const PartBlocks& part);

/// A block of a part, without its bytes and without statistics.
struct StoredPartBlock {
  ldc::OctreeKey key;
  std::vector<uint32_t> children;  ///< numbered from 0 on in each part
  model::EncodedBlock block;
};

/// What a part leaves for the model.
struct StoredPart {
  std::vector<StoredPartBlock> blocks;
  ldc::Front front;  ///< refers to blocks by these numbers
  model::AttributeStatistics statistics;
};

/// The bytes of block i are section i of the file.
Result<StoredPart> read_part_blocks(const WorkFile& file);

}  // namespace surfcast::builder
