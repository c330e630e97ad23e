#include "builder/sorted_ellipsoids.h"

#include <cstring>
#include <utility>

#include "base/contract.h"
#include "model/scalar_bits.h"
#include "scan/scalar_type.h"

namespace surfcast::builder {
namespace {

/// An ellipsoid in the spool; the ordered bits of its scalars follow, 64 each.
struct EllipsoidRecord {
  glm::dvec3 position{0};
  glm::dvec3 values{0};
  glm::dquat rotation{1, 0, 0, 0};
  glm::u32vec3 sample{0};
  glm::u8vec4 color{0};
};

size_t scalars_of(const model::EllipsoidSource& source) {
  return source.attributes.size() - model::kDerivedAttributes;
}

uint64_t bits_at(const surfel::ScalarValues& values, size_t i) {
  return std::visit([i](const auto& typed) { return static_cast<uint64_t>(model::to_ordered_bits(typed[i])); }, values);
}

void append_bits(uint64_t bits, surfel::ScalarValues& values) {
  std::visit(
      [bits](auto& typed) {
        using Value = typename std::decay_t<decltype(typed)>::value_type;
        typed.push_back(model::from_ordered_bits<Value>(static_cast<model::BitsOf<Value>>(bits)));
      },
      values);
}

}  // namespace

EllipsoidSorter::EllipsoidSorter(std::filesystem::path target, const geometry::RootCube& root,
                                 const model::EllipsoidSource& source, bool colors, uint64_t bytes)
    : root_(root),
      source_(source),
      colors_(colors),
      record_(sizeof(EllipsoidRecord) + scalars_of(source) * sizeof(uint64_t)),
      records_(std::move(target), record_.size(), bytes) {}

Status EllipsoidSorter::add(const ellipsoid::Ellipsoids& ellipsoids) {
  SURFCAST_EXPECTS(ellipsoids.scalars.size() == scalars_of(source_));
  for (size_t i = 0; i < ellipsoids.size(); ++i) {
    EllipsoidRecord record{
        ellipsoids.positions[i], ellipsoids.values[i], ellipsoids.rotations[i], ellipsoids.samples[i], {}};
    if (colors_) record.color = glm::u8vec4(ellipsoids.colors[i], 0);
    std::memcpy(record_.data(), &record, sizeof record);
    for (size_t s = 0; s < ellipsoids.scalars.size(); ++s) {
      const uint64_t bits = bits_at(ellipsoids.scalars[s].values, i);
      std::memcpy(record_.data() + sizeof record + s * sizeof bits, &bits, sizeof bits);
    }
    const uint64_t code = geometry::morton_code(root_, record.position);
    if (Status status = records_.add(code, record_); !status) return status;
  }
  return {};
}

ellipsoid::Ellipsoids EllipsoidSorter::empty_columns() const {
  ellipsoid::Ellipsoids ellipsoids;
  for (size_t i = model::kDerivedAttributes; i < source_.attributes.size(); ++i) {
    const model::EllipsoidAttribute& attribute = source_.attributes[i];
    ellipsoids.scalars.push_back({attribute.name, scan::empty_values(static_cast<scan::ScalarType>(attribute.type))});
  }
  return ellipsoids;
}

Result<ellipsoid::Ellipsoids> EllipsoidSorter::take(size_t count) {
  ellipsoid::Ellipsoids ellipsoids = empty_columns();
  const Status status = records_.take(count, [&](std::span<const std::byte> bytes) {
    EllipsoidRecord record;
    std::memcpy(&record, bytes.data(), sizeof record);
    ellipsoids.positions.push_back(record.position);
    ellipsoids.values.push_back(record.values);
    ellipsoids.rotations.push_back(record.rotation);
    const bool on_grid = source_.on_grid();
    ellipsoids.samples.push_back(on_grid ? record.sample
                                         : geometry::deinterleave(geometry::morton_code(root_, record.position)));
    if (colors_) ellipsoids.colors.emplace_back(record.color);
    for (size_t s = 0; s < ellipsoids.scalars.size(); ++s) {
      uint64_t bits = 0;
      std::memcpy(&bits, bytes.data() + sizeof record + s * sizeof bits, sizeof bits);
      append_bits(bits, ellipsoids.scalars[s].values);
    }
  });
  if (!status) return fail(status);
  ellipsoids.counts.assign(count, 1.0F);
  ellipsoids.factors.assign(count, 1.0F);
  return ellipsoids;
}

}  // namespace surfcast::builder
