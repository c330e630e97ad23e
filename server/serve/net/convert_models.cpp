// Lists and descriptions of models as messages.
#include <cmath>

#include "model/volume_facts.h"
#include "net/convert.h"
#include "protocol/errors.h"

namespace surfcast::net {
namespace {

wire::ScanState to_wire(service::ScanStatus::State state) {
  switch (state) {
    case service::ScanStatus::State::kWaiting:
      return wire::SCAN_STATE_WAITING;
    case service::ScanStatus::State::kBuilding:
      return wire::SCAN_STATE_BUILDING;
    case service::ScanStatus::State::kFailed:
      break;
  }
  return wire::SCAN_STATE_FAILED;
}

}  // namespace

void to_wire(const service::ModelList& list, const UploadConfig& uploads, wire::ModelList& message) {
  for (const std::string& name : list.names) message.add_models(protocol::clean_utf8(name));
  for (const service::ScanStatus& scan : list.scans) {
    wire::ScanStatus* to = message.add_scans();
    to->set_model(protocol::clean_utf8(scan.model));
    to->set_state(to_wire(scan.state));
    to->set_done(scan.done);
    to->set_seconds_left(scan.seconds_left);
    to->set_problem(protocol::clean_utf8(scan.problem));
    to->set_edition(scan.edition);
  }
  if (uploads.folder.empty()) return;
  message.mutable_uploads()->set_max_bytes(uploads.bytes);
  for (const std::string& extension : all_extensions(uploads)) message.mutable_uploads()->add_extensions(extension);
}

void to_wire(const picture::TransferPoint& point, wire::TransferPoint& message) {
  const auto code = [](double part) { return static_cast<uint32_t>(std::lround(255 * part)); };
  message.set_value(point.value);
  message.mutable_color()->set_red(code(point.color.r));
  message.mutable_color()->set_green(code(point.color.g));
  message.mutable_color()->set_blue(code(point.color.b));
  message.set_opacity(point.opacity);
}

void to_wire(const model::Volume& volume, const service::VolumePresets& presets, wire::VolumeDescription& message) {
  const glm::dvec3 spacing = spacing_of(volume);
  for (int axis = 0; axis < 3; ++axis) {
    message.add_size(volume.size[axis]);
    message.add_spacing(spacing[axis]);
  }
  message.set_name(protocol::clean_utf8(volume.name));
  message.set_low(volume.low);
  message.set_high(volume.high);
  message.mutable_histogram()->Assign(volume.histogram.begin(), volume.histogram.end());
  message.set_length_unit(protocol::clean_utf8(volume.length_unit));
  message.set_sample_unit(protocol::clean_utf8(volume.sample_unit));
  for (size_t i = 0; i < presets.size(); ++i) {
    wire::PresetPoints& preset = *message.add_presets();
    preset.set_preset(static_cast<wire::TransferPreset>(i));
    for (const picture::TransferPoint& point : presets[i]) to_wire(point, *preset.add_points());
  }
}

void to_wire(const model::EllipsoidSource& source, wire::EllipsoidDescription& message) {
  message.set_name(protocol::clean_utf8(source.name));
  message.set_tensors(source.tensors);
  for (int axis = 0; axis < 3; ++axis) {
    if (source.on_grid()) message.add_size(source.size[axis]);
    message.add_mean_values(source.mean_values[axis]);
  }
  message.set_samples(source.counts.samples);
  message.set_drawn(source.counts.drawn);
  message.set_scale(source.scale());
  message.set_root_scale(source.reach / std::sqrt(source.high));
  message.set_unit_scale(source.reach);
  message.set_mean_fa(source.mean_anisotropy);
  message.set_mean_mode(source.mean_mode);
  message.set_length_unit(protocol::clean_utf8(source.length_unit));
  message.set_sample_unit(protocol::clean_utf8(source.sample_unit));
  for (const model::EllipsoidAttribute& attribute : source.attributes) {
    wire::AttributeRange* to = message.add_ranges();
    to->set_attribute(protocol::clean_utf8(attribute.name));
    to->set_smallest(attribute.smallest);
    to->set_largest(attribute.largest);
    to->set_low(attribute.smallest);
    to->set_high(attribute.largest);
  }
}

namespace {

void to_wire(const model::CoordinateSystem& system, wire::CoordinateSystem& message) {
  message.set_name(protocol::clean_utf8(system.name));
  message.set_id(protocol::clean_utf8(system.id));
  message.set_wkt(protocol::clean_utf8(system.wkt));
}

void to_wire(const model::KindCount& kind, wire::KindCount& message) {
  message.set_kind(protocol::clean_utf8(kind.kind));
  message.set_items(kind.items);
}

void to_wire(const service::MemberDescription& member, wire::MemberDescription& message) {
  message.set_model(protocol::clean_utf8(member.name));
  net::to_wire(member.bounds.min, message.mutable_bounds()->mutable_min());
  net::to_wire(member.bounds.max, message.mutable_bounds()->mutable_max());
  for (const model::KindCount& kind : member.kinds) to_wire(kind, *message.add_kinds());
}

}  // namespace

void to_wire(const std::string& name, const service::ModelDescription& description, wire::ModelDescription& message) {
  const model::ModelInfo& info = description.info;
  message.set_model(name);
  message.set_surfels(info.surfels);
  to_wire(info.bounds.min, message.mutable_bounds()->mutable_min());
  to_wire(info.bounds.max, message.mutable_bounds()->mutable_max());
  message.set_oriented(info.oriented);
  message.set_in_place(info.in_place);
  message.set_z_up(info.z_up);
  message.set_color_bits(static_cast<uint32_t>(info.color_bits));
  for (const std::string& attribute : info.scalar_names) message.add_attributes(protocol::clean_utf8(attribute));
  for (const std::string& source : info.source_names) message.add_sources(protocol::clean_utf8(source));
  message.set_levels(description.levels);
  message.set_blocks(description.blocks);
  message.set_spacing(description.spacing);
  message.set_upside_down(info.upside_down);
  const model::Georeference& georeference = description.georeference;
  if (georeference.known()) to_wire(georeference.system, *message.mutable_system());
  if (georeference.source.known()) to_wire(georeference.source, *message.mutable_source_system());
  for (const model::KindCount& kind : info.kinds) to_wire(kind, *message.add_kinds());
  for (const service::MemberDescription& member : description.members) to_wire(member, *message.add_members());
  for (size_t i = 0; i < description.volumes.size(); ++i) {
    to_wire(description.volumes[i], description.presets[i], *message.add_volumes());
  }
  for (const model::EllipsoidSource& source : description.ellipsoids) to_wire(source, *message.add_ellipsoids());
  message.mutable_elevation()->set_low(info.elevation.low);
  message.mutable_elevation()->set_high(info.elevation.high);
  for (const model::AttributeRange& range : info.ranges) {
    wire::AttributeRange* to = message.add_ranges();
    to->set_attribute(protocol::clean_utf8(range.attribute));
    to->set_smallest(range.smallest);
    to->set_largest(range.largest);
    to->set_low(range.low);
    to->set_high(range.high);
  }
  for (const model::ClassCount& count : info.classes) {
    wire::ClassCount* to = message.add_classes();
    to->set_code(count.code);
    to->set_surfels(count.surfels);
  }
}

}  // namespace surfcast::net
