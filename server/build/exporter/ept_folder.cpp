#include <string>
#include <utility>

#include <oneapi/tbb/parallel_for.h>

#include "base/json_text.h"
#include "exporter/even_sample.h"
#include "exporter/las_bytes.h"
#include "exporter/las_coding.h"
#include "exporter/new_folder.h"
#include "exporter/node_pages.h"
#include "exporter/octree_files.h"
#include "scan/json_access.h"
#include "scan/las_header.h"
#include "scan/las_reader.h"

namespace surfcast::exporter {
namespace {

namespace fs = std::filesystem;
using Bytes = std::vector<std::byte>;
using scan::Json;

std::string name_of(const ldc::OctreeKey& key) {
  std::string name = std::to_string(key.depth);
  for (const uint32_t place : {key.x, key.y, key.z}) name += '-' + std::to_string(place);
  return name;
}

/// The names of EPT for the fields of LAS.
std::string dimension_name(const std::string& field) {
  static const std::vector<std::pair<std::string, std::string>> kNames = {{"intensity", "Intensity"},
                                                                          {"return_number", "ReturnNumber"},
                                                                          {"number_of_returns", "NumberOfReturns"},
                                                                          {"classification_flags", "ClassFlags"},
                                                                          {"scanner_channel", "ScanChannel"},
                                                                          {"scan_direction_flag", "ScanDirectionFlag"},
                                                                          {"edge_of_flight_line", "EdgeOfFlightLine"},
                                                                          {"classification", "Classification"},
                                                                          {"user_data", "UserData"},
                                                                          {"scan_angle", "ScanAngleRank"},
                                                                          {"point_source_id", "PointSourceId"},
                                                                          {"gps_time", "GpsTime"},
                                                                          {"red", "Red"},
                                                                          {"green", "Green"},
                                                                          {"blue", "Blue"},
                                                                          {"nir", "Infrared"}};
  for (const auto& [name, dimension] : kNames) {
    if (name == field) return dimension;
  }
  return field;
}

std::string dimension_type(scan::ScalarType type) {
  if (scan::is_floating(type)) return "float";
  return scan::with_type(type, [](auto zero) { return std::is_signed_v<decltype(zero)>; }) ? "signed" : "unsigned";
}

Json dimension(const std::string& name, scan::ScalarType type) {
  return {{"name", name}, {"type", dimension_type(type)}, {"size", scan::size_of(type)}};
}

/// The dimensions of point records, as readers of LAS give them: scan angles in degrees.
Json schema_of(const scan::LasHeader& header) {
  Json schema = Json::array();
  for (int axis = 0; axis < 3; ++axis) {
    Json entry = dimension(std::string(1, "XYZ"[axis]), scan::ScalarType::kInt32);
    entry["scale"] = header.grid.scale[axis];
    entry["offset"] = header.grid.offset[axis];
    schema.push_back(std::move(entry));
  }
  for (const scan::LasField& field : scan::las_fields(header.point_format)) {
    const bool degrees = field.name == std::string_view("scan_angle");
    schema.push_back(dimension(dimension_name(field.name), degrees ? scan::ScalarType::kFloat32 : field.type));
  }
  for (const scan::LasExtraField& field : header.extra_fields) {
    Json entry = dimension(field.name, field.type);
    if (field.scale != 1) entry["scale"] = field.scale;
    if (field.shift != 0) entry["offset"] = field.shift;
    schema.push_back(std::move(entry));
  }
  return schema;
}

/// Whether a record says what every file has to say.
bool is_of_every_tile(const Bytes& record) {
  const std::string user(reinterpret_cast<const char*>(&record[2]), 16);
  const auto id = scan::load<uint16_t>(&record[18]);
  return (user.starts_with("LASF_Spec") && id == 4) || user.starts_with("LASF_Projection");
}

Json box_of(const glm::dvec3& low, const glm::dvec3& high) {
  return {low.x, low.y, low.z, high.x, high.y, high.z};
}

class EptFolder : public NodeBatch {
 public:
  EptFolder(NewFolder folder, LasHead head, uint64_t most_bytes, size_t most_entries)
      : NodeBatch(most_bytes), folder_(std::move(folder)), head_(std::move(head)), most_entries_(most_entries) {
    head_.compressed = true;
    drop_extended_records(head_);
    std::erase_if(head_.records, [](const Bytes& record) { return !is_of_every_tile(record); });
  }

  Result<uint64_t> finish(const OctreeFacts& facts) override {
    Status status = write_waiting();
    if (status) status = write_hierarchy();
    if (status) status = write_text("ept.json", json_text(description(facts), 1));
    if (status) status = folder_.put_in_place();
    if (!status) return fail(status);
    return bytes_;
  }

 private:
  Status write(std::vector<OctreeNode> nodes) override {
    std::vector<Status> outcomes(nodes.size());
    std::vector<size_t> sizes(nodes.size());
    oneapi::tbb::parallel_for(size_t{0}, nodes.size(), [&](size_t i) {
      const Bytes tile = tile_of(nodes[i].records);
      sizes[i] = tile.size();
      outcomes[i] = folder_.write("ept-data/" + name_of(nodes[i].key) + ".laz", tile);
    });
    for (size_t i = 0; i < nodes.size(); ++i) {
      if (!outcomes[i]) return std::move(outcomes[i]);
      keys_.push_back(nodes[i].key);
      points_.push_back(nodes[i].records.size() / head_.record_length);
      bytes_ += sizes[i];
    }
    return {};
  }

  /// A file of LAZ with one chunk.
  [[nodiscard]] Bytes tile_of(const Bytes& records) const {
    LasHead head = head_;
    LasCounts counts;
    counts.add(records, head);
    head.chunk_size = static_cast<uint32_t>(counts.points);
    add_laszip_record(head);
    const size_t data_offset = bytes_before_points(head).size() - sizeof(int64_t);
    fill_in_header(head, counts, data_offset);
    Bytes tile = bytes_before_points(head);
    const Bytes chunk = laz::encode_chunk(coding_of(head), records);
    add_bytes(tile, chunk);
    put(tile, data_offset, static_cast<int64_t>(tile.size()));
    const laz::ChunkSize size{counts.points, chunk.size()};
    add_bytes(tile, laz::encode_chunk_table(coding_of(head), {&size, 1}));
    return tile;
  }

  Status write_hierarchy() {
    const std::vector<NodePage> pages = make_pages(keys_, most_entries_);
    for (const NodePage& page : pages) {
      Json json = Json::object();
      for (const size_t i : page.nodes) json[name_of(keys_[i])] = points_[i];
      for (const size_t i : page.subpages) json[name_of(keys_[pages[i].nodes.front()])] = -1;
      Status status = write_text("ept-hierarchy/" + name_of(keys_[page.nodes.front()]) + ".json", json_text(json));
      if (!status) return status;
    }
    return {};
  }

  [[nodiscard]] Json description(const OctreeFacts& facts) const {
    const scan::LasHeader header = header_of(head_);
    const geometry::Box bounds = bounds_of(header.grid, facts.counts);
    Json srs = Json::object();
    if (header.crs.find('[') != std::string::npos) srs["wkt"] = header.crs;
    return {{"version", "1.0.0"},
            {"dataType", "laszip"},
            {"hierarchyType", "json"},
            {"points", facts.counts.points},
            {"bounds", box_of(facts.cube.min, facts.cube.min + facts.cube.side)},
            {"boundsConforming", box_of(bounds.min, bounds.max)},
            {"span", static_cast<int>(1 / kSampleSpacing)},
            {"schema", schema_of(header)},
            {"srs", srs}};
  }

  Status write_text(const std::string& name, const std::string& text) {
    bytes_ += text.size();
    return folder_.write(name, std::as_bytes(std::span(text)));
  }

  NewFolder folder_;
  LasHead head_;
  size_t most_entries_;
  std::vector<ldc::OctreeKey> keys_;
  std::vector<uint64_t> points_;
  uint64_t bytes_ = 0;
};

}  // namespace

Result<std::unique_ptr<NodeBatch>> create_ept(const fs::path& target, LasHead head, uint64_t most_bytes,
                                              size_t most_entries) {
  Result<NewFolder> folder = NewFolder::create(target);
  if (!folder) return fail(folder);
  for (const char* name : {"ept-data", "ept-hierarchy"}) {
    if (Status status = folder->make_folder(name); !status) return fail(status);
  }
  return std::make_unique<EptFolder>(std::move(*folder), std::move(head), most_bytes, most_entries);
}

}  // namespace surfcast::exporter
