#include "grid/grid_files.h"

#include "support/packing.h"

namespace surfcast::testing {
namespace {

/// Sets numbers at an offset of a record.
template <typename T, typename From>
void put(Bytes& record, size_t offset, const std::vector<From>& values, bool big) {
  for (const From value : values) {
    Bytes number;
    number.add<T>(static_cast<T>(value), big);
    for (size_t i = 0; i < sizeof(T); ++i) record.set<char>(offset + i, number.text()[i]);
    offset += sizeof(T);
  }
}

void put_version1(const NiftiSettings& s, Bytes& record) {
  put<int32_t, int>(record, 0, {348}, s.big);
  put<int16_t>(record, 40, std::vector<int64_t>{static_cast<int64_t>(s.sizes.size())}, s.big);
  put<int16_t>(record, 42, s.sizes, s.big);
  put<int16_t, int>(record, 68, {s.intent, s.type, 16}, s.big);
  put<float>(record, 76, s.spacing, s.big);
  put<float, double>(record, 108, {s.pair ? 0.0 : 352.0, s.slope, s.intercept}, s.big);
  record.set<uint8_t>(123, s.units);
  put<int16_t, int>(record, 252, {s.qform, s.sform}, s.big);
  put<float>(record, 256, s.quaternion, s.big);
  put<float>(record, 280, s.rows, s.big);
  for (size_t i = 0; i < 4; ++i) record.set<char>(344 + i, (s.pair ? "ni1" : "n+1")[i]);
  if (!s.pair) record.set<uint32_t>(348, 0);
}

void put_version2(const NiftiSettings& s, Bytes& record) {
  put<int32_t, int>(record, 0, {540}, s.big);
  const std::string magic = std::string(s.pair ? "ni2" : "n+2") + std::string("\0\r\n\032\n", 5);
  for (size_t i = 0; i < magic.size(); ++i) record.set<char>(4 + i, magic[i]);
  put<int16_t, int>(record, 12, {s.type, 16}, s.big);
  put<int64_t>(record, 16, std::vector<int64_t>{static_cast<int64_t>(s.sizes.size())}, s.big);
  put<int64_t>(record, 24, s.sizes, s.big);
  put<double>(record, 104, s.spacing, s.big);
  put<int64_t, int>(record, 168, {s.pair ? 0 : 544}, s.big);
  put<double, double>(record, 176, {s.slope, s.intercept}, s.big);
  put<int32_t, int>(record, 344, {s.qform, s.sform}, s.big);
  put<double>(record, 352, s.quaternion, s.big);
  put<double>(record, 400, s.rows, s.big);
  put<int32_t, int>(record, 500, {s.units, s.intent}, s.big);
  if (!s.pair) record.set<uint32_t>(540, 0);
}

}  // namespace

std::string nifti_header(const NiftiSettings& settings) {
  Bytes record(std::string(settings.version == 1 ? 348 : 540, '\0'));
  settings.version == 1 ? put_version1(settings, record) : put_version2(settings, record);
  return record.text();
}

std::string vti(const std::string& file_attributes, const std::string& image_attributes, const std::string& array,
                const std::string& behind) {
  return "<?xml version=\"1.0\"?>\n<VTKFile type=\"ImageData\" version=\"1.0\" " + file_attributes + ">\n<ImageData " +
         image_attributes + ">\n<Piece Extent=" + kVtiExtent.substr(kVtiExtent.find('"')) +
         ">\n<PointData Scalars=\"ramp\">\n" + array + "\n</PointData>\n</Piece>\n</ImageData>\n" + behind +
         "</VTKFile>\n";
}

VtkBlocks vtk_blocks(std::string_view bytes, bool wide, bool big) {
  constexpr size_t kBlock = 10;
  std::vector<std::string> blocks;
  for (size_t at = 0; at < bytes.size(); at += kBlock) blocks.push_back(zlib(bytes.substr(at, kBlock)));
  std::vector<uint64_t> numbers = {blocks.size(), kBlock, bytes.size() % kBlock};
  VtkBlocks result;
  for (const std::string& block : blocks) {
    numbers.push_back(block.size());
    result.blocks += block;
  }
  result.header =
      wide ? packed_numbers(numbers, big) : packed_numbers(std::vector<uint32_t>(numbers.begin(), numbers.end()), big);
  return result;
}

std::vector<GridSample> grid_samples() {
  const std::string nrrd = "NRRD0004\ntype: short\ndimension: 3\nsizes: 3 2 2\nendian: little\nspacings: 1 2 3\n";
  const std::string meta = "ObjectType = Image\nNDims = 3\nDimSize = 3 2 2\nElementType = MET_SHORT\n";
  const std::string vtk =
      "\nDATASET STRUCTURED_POINTS\nDIMENSIONS 3 2 2\nSPACING 1 2 3\nORIGIN 0 0 0\nPOINT_DATA 12\n"
      "SCALARS ramp short 1\nLOOKUP_TABLE default\n";
  const std::string array = R"(<DataArray type="Int16" Name="ramp" format=)";
  const VtkBlocks blocks = vtk_blocks(ramp_bytes(), false, false);
  const std::string length = packed_numbers(std::vector<uint32_t>{24});
  const std::string little = R"(byte_order="LittleEndian")";
  NiftiSettings second;
  second.version = 2;
  return {
      {"raw.nrrd", nrrd + "encoding: raw\n\n" + ramp_bytes()},
      {"gzip.nrrd", nrrd + "encoding: gzip\n\n" + gzip(ramp_bytes())},
      {"bzip2.nrrd", nrrd + "encoding: bzip2\n\n" + bzip2(ramp_bytes())},
      {"text.nrrd", nrrd + "encoding: text\n\n" + ramp_text()},
      {"raw.mha", meta + "ElementDataFile = LOCAL\n" + ramp_bytes()},
      {"zlib.mha", meta + "CompressedData = True\nElementDataFile = LOCAL\n" + zlib(ramp_bytes())},
      {"text.mha", meta + "BinaryData = False\nElementDataFile = LOCAL\n" + ramp_text()},
      {"text.vtk", "# vtk DataFile Version 3.0\na ramp\nASCII" + vtk + ramp_text()},
      {"binary.vtk", "# vtk DataFile Version 3.0\na ramp\nBINARY" + vtk + ramp_bytes(true)},
      {"text.vti", vti(little, kVtiExtent, array + "\"ascii\">" + ramp_text() + "</DataArray>")},
      {"base64.vti", vti(little, kVtiExtent, array + "\"binary\">" + base64(length + ramp_bytes()) + "</DataArray>")},
      {"packed.vti", vti(little + " compressor=\"vtkZLibDataCompressor\"", kVtiExtent,
                         array + "\"binary\">" + base64(blocks.header) + base64(blocks.blocks) + "</DataArray>")},
      {"appended.vti", vti(little, kVtiExtent, array + "\"appended\" offset=\"0\"/>",
                           "<AppendedData encoding=\"raw\">\n_" + length + ramp_bytes() + "\n</AppendedData>\n")},
      {"first.nii", nifti_header({}) + ramp_bytes()},
      {"second.nii", nifti_header(second) + ramp_bytes()},
      {"packed.nii.gz", gzip(nifti_header({}) + ramp_bytes())},
  };
}

}  // namespace surfcast::testing
