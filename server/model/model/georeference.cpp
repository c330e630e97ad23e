#include "model/georeference.h"

#include <algorithm>
#include <utility>

#include "base/file_source.h"
#include "model/byte_stream.h"
#include "model/format.h"

namespace surfcast::model {
namespace {

Result<std::vector<std::byte>> read_range(const ByteSource& source, uint64_t first, uint64_t end) {
  std::vector<std::byte> bytes(end - first);
  if (Status status = source.read(first, bytes); !status) return fail(status);
  return bytes;
}

Result<Georeference> georeference_of(const ByteSource& source) {
  const Result<std::vector<std::byte>> head = read_range(source, 0, std::min<uint64_t>(source.size(), kHeaderBytes));
  if (!head) return fail(head);
  const Result<ModelHeader> header = read_header(*head, source.size());
  if (!header) return fail(header);
  if (header->georeference_offset == 0) return Georeference();
  const Result<std::vector<std::byte>> bytes =
      read_range(source, header->georeference_offset, header->directory_offset);
  if (!bytes) return fail(bytes);
  return read_georeference(*bytes);
}

}  // namespace

std::vector<std::byte> write_georeference(const Georeference& georeference) {
  ByteWriter strings;
  for (const CoordinateSystem* system : {&georeference.system, &georeference.source}) {
    for (const std::string* text : {&system->name, &system->id, &system->wkt}) strings.put_string(*text);
  }
  ByteWriter writer;
  writer.put(checksum_of(strings.bytes()));
  writer.put_bytes(strings.bytes());
  return std::move(writer).take();
}

Result<Georeference> read_georeference(std::span<const std::byte> bytes) {
  ByteReader reader(bytes);
  const auto checksum = reader.get<uint64_t>();
  if (!reader.ok() || checksum != checksum_of(reader.rest())) {
    return fail(ErrorKind::kInvalidInput, "model states a damaged coordinate system");
  }
  Georeference georeference;
  for (CoordinateSystem* system : {&georeference.system, &georeference.source}) {
    for (std::string* text : {&system->name, &system->id, &system->wkt}) *text = reader.get_string();
  }
  if (!reader.ok() || !reader.rest().empty() || !georeference.known()) {
    return fail(ErrorKind::kInvalidInput, "model states a damaged coordinate system");
  }
  return georeference;
}

Result<Georeference> load_georeference(const ByteSource& source) {
  return georeference_of(source).map_error([&](const Error& error) {
    return Error{error.kind, source.name() + ": " + error.message};
  });
}

Result<Georeference> load_georeference(const std::filesystem::path& path) {
  Result<PositionedFile> file = PositionedFile::open(path);
  if (!file) return fail(file);
  return load_georeference(FileSource(std::move(*file), path));
}

}  // namespace surfcast::model
