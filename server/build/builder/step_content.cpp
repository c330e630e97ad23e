#include "builder/step_content.h"

#include <algorithm>
#include <cstring>
#include <type_traits>
#include <utility>

#include "builder/cloud_columns.h"
#include "model/byte_stream.h"
#include "model/write_blocks.h"

namespace surfcast::builder {
namespace {

using model::ByteReader;
using model::ByteWriter;

// `fields(value, use)` calls `use` with each field of a value, for reading and for writing.

template <typename Vector, typename Use>
void vector_fields(Vector& v, const Use& use) {
  use(v.x);
  use(v.y);
  use(v.z);
}

template <typename Votes, typename Use>
void votes_fields(Votes& votes, const Use& use) {
  vector_fields(votes.origin, use);
  use(votes.area);
  vector_fields(votes.moment, use);
  use(votes.spread);
  vector_fields(votes.normal, use);
  use(votes.flux);
  use(votes.towards);
  use(votes.agreement);
  use(votes.conflict);
}

template <typename Site, typename Use>
void site_fields(Site& site, const Use& use) {
  use(site.place);
  vector_fields(site.normal, use);
  use(site.tree);
}

template <typename Sample, typename Use>
void sample_fields(Sample& sample, const Use& use) {
  vector_fields(sample.position, use);
  use(sample.radius);
}

template <typename Report, typename Use>
void report_fields(Report& report, const Use& use) {
  for (auto* count : {&report.points_read, &report.not_finite, &report.duplicates, &report.zero_normals,
                      &report.normals_estimated, &report.radii_estimated, &report.scatter}) {
    use(*count);
  }
  use(report.oriented);
}

template <typename Decision, typename Use>
void decision_fields(Decision& decision, const Use& use) {
  for (auto* count : {&decision.stated, &decision.missing, &decision.stated_scatter, &decision.missing_scatter}) {
    use(*count);
  }
  use(decision.factor);
}

template <typename Spacings, typename Use>
void spacings_fields(Spacings& spacings, const Use& use) {
  use(spacings.median);
  use(spacings.least);
  use(spacings.most);
}

template <typename Key, typename Use>
void key_fields(Key& key, const Use& use) {
  use(key.depth);
  vector_fields(key, use);
}

template <typename Surfel, typename Use>
void coarse_fields(Surfel& surfel, const Use& use) {
  vector_fields(surfel.position, use);
  vector_fields(surfel.normal, use);
  use(surfel.radius);
  vector_fields(surfel.light, use);
  use(surfel.opacity);
  use(surfel.intensity);
  use(surfel.classification);
  use(surfel.scatter);
}

template <typename Block, typename Use>
void block_fields(Block& block, const Use& use) {
  vector_fields(block.grid.scale, use);
  vector_fields(block.grid.offset, use);
  vector_fields(block.origin, use);
  vector_fields(block.extent, use);
  use(block.items);
  use(block.scatter);
  use(block.spacing);
  use(block.max_radius);
}

template <typename Cone, typename Use>
void cone_fields(Cone& cone, const Use& use) {
  vector_fields(cone.axis, use);
  use(cone.half_angle);
}

/// Writes numbers, flags and enumerations.
auto put_into(ByteWriter& bytes) {
  return [&bytes](const auto& value) { bytes.put(value); };
}

auto get_from(ByteReader& bytes) {
  return [&bytes](auto& value) { value = bytes.get<std::decay_t<decltype(value)>>(); };
}

/// Writes a list: its length, and each element by `put_one`.
template <typename T, typename Put>
void put_list(ByteWriter& bytes, const std::vector<T>& list, const Put& put_one) {
  bytes.put<uint64_t>(list.size());
  for (const T& element : list) put_one(element);
}

/// Reads such a list, however long it claims to be.
template <typename T, typename Get>
void get_list(ByteReader& bytes, std::vector<T>& list, const Get& get_one) {
  for (auto left = bytes.get<uint64_t>(); left > 0 && bytes.ok(); --left) get_one(list.emplace_back());
}

void put_samples(ByteWriter& bytes, const std::vector<estimation::SurfaceSample>& samples) {
  put_list(bytes, samples, [&](const estimation::SurfaceSample& sample) { sample_fields(sample, put_into(bytes)); });
}

void get_samples(ByteReader& bytes, std::vector<estimation::SurfaceSample>& samples) {
  get_list(bytes, samples, [&](estimation::SurfaceSample& sample) { sample_fields(sample, get_from(bytes)); });
}

void put_signs(ByteWriter& bytes, const estimation::PartSigns& signs) {
  put_list(bytes, signs.trees, [&](const estimation::TreeVotes& votes) { votes_fields(votes, put_into(bytes)); });
  bytes.put(signs.resolved_area);
  bytes.put(signs.agreement);
  bytes.put(signs.conflict);
  bytes.put(signs.all_known);
  put_list(bytes, signs.border, [&](const estimation::BorderSite& site) { site_fields(site, put_into(bytes)); });
}

void get_signs(ByteReader& bytes, estimation::PartSigns& signs) {
  get_list(bytes, signs.trees, [&](estimation::TreeVotes& votes) { votes_fields(votes, get_from(bytes)); });
  signs.resolved_area = bytes.get<double>();
  signs.agreement = bytes.get<double>();
  signs.conflict = bytes.get<double>();
  signs.all_known = bytes.get<bool>();
  get_list(bytes, signs.border, [&](estimation::BorderSite& site) { site_fields(site, get_from(bytes)); });
}

std::vector<std::byte> bytes_of_evidence(const MadePart& part) {
  ByteWriter bytes;
  put_signs(bytes, part.signs);
  put_list(bytes, part.surfels.radii, [&](const estimation::RadiusComparison& comparison) {
    put_list(bytes, comparison.numbers(), put_into(bytes));
  });
  put_samples(bytes, part.surfels.samples);
  report_fields(part.report, put_into(bytes));
  return std::move(bytes).take();
}

/// The sources of a part, and how many of its surfels are its own.
std::vector<std::byte> bytes_of_sources(const MadePart& part) {
  ByteWriter bytes;
  bytes.put<uint64_t>(part.own);
  bytes.put<uint64_t>(part.surfels.cloud.size());
  bytes.put<uint64_t>(part.inputs.size());
  for (size_t i = 0; i < part.inputs.size(); ++i) {
    bytes.put<uint64_t>(part.inputs[i]);
    bytes.put<uint64_t>(part.surfels.cloud.sources[i].count);
  }
  return std::move(bytes).take();
}

/// Reads these into a part without surfels; returns how many it has. The reader is not ok if an input does not exist.
uint64_t get_sources(ByteReader& bytes, std::span<const InputName> names, MadePart& part) {
  part.own = bytes.get<uint64_t>();
  const auto size = bytes.get<uint64_t>();
  uint64_t first = 0;
  for (auto left = bytes.get<uint64_t>(); left > 0 && bytes.ok(); --left) {
    const auto input = bytes.get<uint64_t>();
    const auto count = bytes.get<uint64_t>();
    if (input >= names.size()) return 0;
    part.inputs.push_back(input);
    part.surfels.cloud.sources.push_back({names[input].name, first, count, names[input].grid});
    first += count;
  }
  return first == size && part.own <= size ? size : 0;
}

/// Calls `use` with the memory of each array of the surfels, in the order of the sections.
template <typename Use>
Status for_each_array(estimation::PartSurfels& surfels, const Use& use) {
  std::vector<std::span<std::byte>> arrays{std::as_writable_bytes(std::span(surfels.trees)),
                                           std::as_writable_bytes(std::span(surfels.estimates.radii)),
                                           std::as_writable_bytes(std::span(surfels.estimates.kinds))};
  const std::vector<std::span<std::byte>> columns = column_memory(surfels.cloud, 0, surfels.cloud.size());
  arrays.insert(arrays.end(), columns.begin(), columns.end());
  for (const std::span<std::byte> array : arrays) {
    if (Status status = use(array); !status) return status;
  }
  return {};
}

// Sections of a part.
constexpr size_t kEvidenceSection = 0;
constexpr size_t kSourcesSection = 1;
constexpr size_t kFirstArray = 2;

// Sections of what is decided for all parts.
constexpr size_t kDecisionsSection = 0;
constexpr size_t kSamplesSection = 1;

void put_block(ByteWriter& bytes, const ldc::TreeBlock& block, const model::EncodedBlock& encoded) {
  key_fields(block.key, put_into(bytes));
  put_list(bytes, block.children, put_into(bytes));
  block_fields(encoded, put_into(bytes));
  bytes.put(encoded.normals.has_value());
  if (encoded.normals) cone_fields(*encoded.normals, put_into(bytes));
}

void get_block(ByteReader& bytes, StoredPartBlock& block) {
  key_fields(block.key, get_from(bytes));
  get_list(bytes, block.children, get_from(bytes));
  block_fields(block.block, get_from(bytes));
  if (bytes.get<bool>()) cone_fields(block.block.normals.emplace(), get_from(bytes));
}

void put_front(ByteWriter& bytes, const ldc::Front& front) {
  put_list(bytes, front, [&](const ldc::FrontCell& cell) {
    key_fields(cell.key, put_into(bytes));
    put_list(bytes, cell.blocks, put_into(bytes));
    put_list(bytes, cell.surfels, [&](const ldc::CoarseSurfel& surfel) { coarse_fields(surfel, put_into(bytes)); });
    bytes.put(cell.largest_radius);
  });
}

void get_front(ByteReader& bytes, ldc::Front& front) {
  get_list(bytes, front, [&](ldc::FrontCell& cell) {
    key_fields(cell.key, get_from(bytes));
    get_list(bytes, cell.blocks, get_from(bytes));
    get_list(bytes, cell.surfels, [&](ldc::CoarseSurfel& surfel) { coarse_fields(surfel, get_from(bytes)); });
    cell.surfels.shrink_to_fit();
    cell.largest_radius = bytes.get<float>();
  });
}

/// False if a block states children that do not precede it, or a front blocks that the part does not have.
bool is_consistent(const StoredPart& part) {
  for (size_t i = 0; i < part.blocks.size(); ++i) {
    const std::vector<uint32_t>& children = part.blocks[i].children;
    if (std::any_of(children.begin(), children.end(), [i](uint32_t child) { return child >= i; })) return false;
  }
  return std::all_of(part.front.begin(), part.front.end(), [&part](const ldc::FrontCell& cell) {
    return std::all_of(cell.blocks.begin(), cell.blocks.end(),
                       [&part](uint32_t block) { return block < part.blocks.size(); });
  });
}

}  // namespace

Status write_part(WorkFileWriter& file, MadePart& part) {
  Status status = file.add(bytes_of_evidence(part));
  if (status) status = file.add(bytes_of_sources(part));
  if (!status) return status;
  return for_each_array(part.surfels, [&file](std::span<const std::byte> array) { return file.add(array); });
}

Result<PartEvidence> read_evidence(const WorkFile& file) {
  const Result<std::vector<std::byte>> section = file.read(kEvidenceSection);
  if (!section) return fail(section);
  ByteReader bytes(*section);
  PartEvidence evidence;
  get_signs(bytes, evidence.signs);
  bool known = true;
  get_list(bytes, evidence.radii, [&](estimation::RadiusComparison& comparison) {
    std::vector<uint64_t> numbers;
    get_list(bytes, numbers, get_from(bytes));
    const std::optional<estimation::RadiusComparison> read = estimation::RadiusComparison::of_numbers(numbers);
    known = known && read.has_value();
    if (read) comparison = *read;
  });
  get_samples(bytes, evidence.samples);
  report_fields(evidence.report, get_from(bytes));
  if (!bytes.ok() || !known) return fail(file.damaged());
  return evidence;
}

Result<MadePart> read_surfels(const WorkFile& file, const scan::ScanSchema& schema, std::span<const InputName> inputs) {
  const Result<std::vector<std::byte>> section = file.read(kSourcesSection);
  if (!section) return fail(section);
  ByteReader bytes(*section);
  MadePart part;
  const uint64_t size = get_sources(bytes, inputs, part);
  // The first array has 4 bytes for each surfel.
  if (!bytes.ok() || file.sections() <= kFirstArray || file.bytes_of(kFirstArray) != size * sizeof(uint32_t)) {
    return fail(file.damaged());
  }
  std::vector<surfel::SourceRange> sources = std::move(part.surfels.cloud.sources);
  part.surfels.cloud = empty_cloud(schema, size);
  part.surfels.cloud.sources = std::move(sources);
  part.surfels.cloud.normals.resize(size);
  part.surfels.trees.resize(size);
  part.surfels.estimates.radii.resize(size);
  part.surfels.estimates.kinds.resize(size);
  size_t next = kFirstArray;
  Status status = for_each_array(part.surfels, [&](std::span<std::byte> array) { return file.read(next++, array); });
  if (!status) return fail(status);
  return part;
}

Status write_scene(WorkFileWriter& file, const SceneResult& scene,
                   const std::vector<estimation::SurfaceSample>& samples) {
  ByteWriter bytes;
  bytes.put(scene.decisions.signs.oriented);
  bytes.put(scene.decisions.signs.face_up);
  put_list(bytes, scene.decisions.signs.flipped,
           [&](const std::vector<uint8_t>& trees) { put_list(bytes, trees, put_into(bytes)); });
  put_list(bytes, scene.decisions.radii, [&](const estimation::RadiusDecision& decision) {
    bytes.put(static_cast<uint8_t>(decision.outcome));
    decision_fields(decision, put_into(bytes));
    bytes.put(decision.stating.has_value());
    if (decision.stating) spacings_fields(*decision.stating, put_into(bytes));
  });
  report_fields(scene.report, put_into(bytes));
  Status status = file.add(bytes.bytes());
  if (!status) return status;
  ByteWriter of_samples;
  put_samples(of_samples, samples);
  return file.add(of_samples.bytes());
}

Result<SceneResult> read_scene(const WorkFile& file) {
  const Result<std::vector<std::byte>> section = file.read(kDecisionsSection);
  if (!section) return fail(section);
  ByteReader bytes(*section);
  SceneResult scene;
  scene.decisions.signs.oriented = bytes.get<bool>();
  scene.decisions.signs.face_up = bytes.get<bool>();
  get_list(bytes, scene.decisions.signs.flipped,
           [&](std::vector<uint8_t>& trees) { get_list(bytes, trees, get_from(bytes)); });
  get_list(bytes, scene.decisions.radii, [&](estimation::RadiusDecision& decision) {
    decision.outcome = static_cast<estimation::RadiusOutcome>(bytes.get<uint8_t>());
    decision_fields(decision, get_from(bytes));
    if (bytes.get<bool>()) spacings_fields(decision.stating.emplace(), get_from(bytes));
  });
  report_fields(scene.report, get_from(bytes));
  if (!bytes.ok()) return fail(file.damaged());
  return scene;
}

Result<std::vector<estimation::SurfaceSample>> read_samples(const WorkFile& file) {
  const Result<std::vector<std::byte>> section = file.read(kSamplesSection);
  if (!section) return fail(section);
  ByteReader bytes(*section);
  std::vector<estimation::SurfaceSample> samples;
  get_samples(bytes, samples);
  if (!bytes.ok()) return fail(file.damaged());
  return samples;
}

Status write_part_blocks(WorkFileWriter& file, const PartBlocks& part) {
  ByteWriter table;
  model::AttributeStatistics statistics;
  const std::vector<ldc::TreeBlock>& blocks = part.subtree.blocks;
  table.put<uint64_t>(blocks.size());
  Status status = model::encode_blocks(part.cloud, blocks, [&](size_t i, const model::EncodedBlock& encoded) {
    put_block(table, blocks[i], encoded);
    statistics.add(encoded.statistics);
    return file.add(encoded.bytes);
  });
  if (!status) return status;
  put_front(table, part.subtree.front);
  statistics.write(table);
  return file.add(table.bytes());
}

Result<StoredPart> read_part_blocks(const WorkFile& file) {
  if (file.sections() == 0) return fail(file.damaged());
  const Result<std::vector<std::byte>> section = file.read(file.sections() - 1);
  if (!section) return fail(section);
  ByteReader bytes(*section);
  StoredPart part;
  get_list(bytes, part.blocks, [&](StoredPartBlock& block) { get_block(bytes, block); });
  get_front(bytes, part.front);
  part.statistics = model::AttributeStatistics::read(bytes);
  if (!bytes.ok() || part.blocks.size() + 1 != file.sections() || !is_consistent(part)) return fail(file.damaged());
  return part;
}

}  // namespace surfcast::builder
