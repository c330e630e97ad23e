#include "point_tree/node_points.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "base/invalid_input.h"
#include "estimation/clean_points.h"
#include "geometry/zone.h"
#include "point_tree/columns.h"
#include "scan/column_roles.h"
#include "scan/table_facts.h"

namespace surfcast::point_tree {
namespace {

/// The columns and traits of a tree, for deciding what they mean.
class ColumnsOfTree : public scan::RowSource {
 public:
  explicit ColumnsOfTree(const NodeReader& reader) : reader_(reader) {}

  [[nodiscard]] const scan::RowTraits& traits() const override { return reader_.traits(); }
  [[nodiscard]] const std::vector<scan::ColumnInfo>& columns() const override { return reader_.columns(); }
  [[nodiscard]] size_t pieces() const override { return 0; }
  [[nodiscard]] Result<scan::PointTable> read(size_t /*piece*/) const override { return scan::PointTable(); }

 private:
  const NodeReader& reader_;
};

/// Of the side of a cell: points were placed before they were rounded.
constexpr double kOutside = 0.01;

bool lies_near(const geometry::Box& cell, const glm::dvec3& point) {
  const glm::dvec3 margin = kOutside * cell.size();
  return geometry::contains({cell.min - margin, cell.max + margin}, point);
}

}  // namespace

size_t NodePoints::bytes() const {
  size_t each = sizeof(glm::dvec3) + sizeof(uint64_t);
  if (!points.normals.empty()) each += sizeof(glm::vec3);
  if (!points.radii.empty()) each += sizeof(float);
  if (points.colors) each += sizeof(glm::u16vec3);
  return (each + bytes_of_scalars(points.scalars)) * codes.size();
}

Result<scan::TableMeaning> decide_meaning(const NodeReader& reader, const scan::PointTable& root) {
  const Result<scan::ColumnRoles> roles = scan::assign_roles(reader.columns(), {});
  if (!roles) return fail(roles);
  return scan::decide_meaning(ColumnsOfTree(reader), scan::find_facts(root, *roles, false));
}

Result<NodePoints> sort_points(const scan::PointTable& table, const scan::TableMeaning& meaning, const Cells& cells,
                               const ldc::OctreeKey& key) {
  scan::ScanPoints read = scan::points_of(table, meaning);
  estimation::SurfelReport report;
  estimation::drop_unusable_points(read, report);
  const geometry::Box cell = cells.box_of(key);
  std::vector<std::pair<uint64_t, uint32_t>> places(read.size());
  for (uint32_t i = 0; i < places.size(); ++i) {
    if (!lies_near(cell, read.positions[i])) return invalid_input("has points outside of its cell");
    places[i] = {cells.code_of(read.positions[i], key), i};
  }
  std::ranges::sort(places);
  std::vector<uint32_t> order(places.size());
  NodePoints sorted;
  sorted.codes.reserve(places.size());
  for (size_t i = 0; i < places.size(); ++i) {
    order[i] = places[i].second;
    sorted.codes.push_back(places[i].first);
  }
  sorted.points = empty_like(read);
  append_points(read, order, sorted.points);
  return sorted;
}

}  // namespace surfcast::point_tree
