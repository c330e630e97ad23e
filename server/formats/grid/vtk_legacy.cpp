#include <array>
#include <bit>
#include <utility>
#include <vector>

#include "grid/header_text.h"
#include "grid/readers.h"
#include "grid/vtk_legacy_file.h"
#include "scan/text_tokens.h"

namespace surfcast::grid {
namespace {

Result<GridHeader> describe_legacy(const LegacyFile& file, const LegacyArray& array) {
  GridHeader header;
  header.format = kVtk;
  header.name = scan::printable(array.facts.name);
  header.type = array.numbers.type;
  const Result<SampleKind> kind = kind_of(array.facts);
  if (!kind) return fail(kind);
  header.kind = *kind;
  place_samples(file.dimensions, affine(glm::dmat3(1.0), file.spacing, file.origin), array.facts.of_cells, header);
  if (Status status = check_header(header); !status) return fail(status);
  if (header.samples() * header.components() != array.numbers.count) {
    return fail(ErrorKind::kInvalidInput, "VTK: the array " + header.name + " does not have a value for each sample");
  }
  return header;
}

}  // namespace

Result<StoredGrid> parse_vtk_legacy(const GridFile& file) {
  static constexpr std::array<std::string_view, 1> kGrids{"structured_points"};
  const Result<LegacyFile> grid = scan_vtk_legacy(file.text(), kGrids);
  if (!grid) return fail(grid);
  std::vector<VtkArray> facts;
  for (const LegacyArray& array : grid->arrays) facts.push_back(array.facts);
  const Result<size_t> chosen = choose_array(facts, file.array);
  if (!chosen) return fail(chosen);
  const LegacyArray& array = grid->arrays[*chosen];
  Result<GridHeader> header = describe_legacy(*grid, array);
  if (!header) return fail(header);
  StoredSamples samples;
  samples.packing = grid->binary ? Packing::kRaw : Packing::kText;
  samples.type = header->type;
  samples.bytes = header->samples() * header->sample_bytes();
  samples.offset = array.numbers.offset;
  samples.file = file.file;
  StoredGrid stored;
  stored.header = std::move(*header);
  stored.swapped = grid->binary && std::endian::native == std::endian::little;
  stored.open = [samples = std::move(samples)] { return open_samples(samples); };
  return stored;
}

}  // namespace surfcast::grid
