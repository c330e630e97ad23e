#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "grid/grid_files.h"
#include "support/packing.h"

namespace surfcast::grid {
namespace {

using testing::base64;
using ::testing::ElementsAre;
using testing::expect_ramp;
using testing::fault_of;
using ::testing::HasSubstr;
using testing::kVtiExtent;
using testing::packed_numbers;
using testing::ramp_bytes;
using testing::ramp_text;
using testing::vti;
using testing::world;
using testing::write;

std::string legacy(bool binary, const std::string& geometry, const std::string& data) {
  return "# vtk DataFile Version 4.2\ntitle\n" + std::string(binary ? "BINARY" : "ASCII") +
         "\nDATASET STRUCTURED_POINTS\n" + geometry + data;
}

const std::string kPoints = "DIMENSIONS 3 2 2\nORIGIN 1 2 3\nSPACING 0.5 -1 2\n";

TEST(VtkLegacyTest, TextAndBigEndianBinaryAreRead) {
  const model::TestFolder folder;
  const std::string scalars = "POINT_DATA 12\nSCALARS ramp short\nLOOKUP_TABLE default\n";
  for (const bool binary : {false, true}) {
    const GridHeader header = expect_ramp(
        write(folder / "grid.vtk", legacy(binary, kPoints, scalars + (binary ? ramp_bytes(true) : ramp_text()))));
    EXPECT_EQ(header.name, "ramp");
    EXPECT_EQ(world(header, 2, 1, 1), glm::dvec3(2, 1, 5));
  }
}

TEST(VtkLegacyTest, TheGridOfCellsIsHalfAStepFurther) {
  const model::TestFolder folder;
  const GridHeader header = expect_ramp(
      write(folder / "grid.vtk", legacy(false, "DIMENSIONS 4 3 3\nORIGIN 1 2 3\nASPECT_RATIO 1 2 4\n",
                                        "CELL_DATA 12\nSCALARS ramp short 1\nLOOKUP_TABLE default\n" + ramp_text())));
  EXPECT_EQ(header.size, (std::array<uint64_t, 3>{3, 2, 2}));
  EXPECT_EQ(world(header, 0, 0, 0), glm::dvec3(1.5, 3, 5));
}

/// Arrays of several kinds before and behind the ramp.
std::string many_arrays(bool binary) {
  const auto numbers = [binary](size_t count, size_t width) {
    std::string text;
    for (size_t i = 0; i < count; ++i) text += binary ? std::string(width, '\n') : "1 ";
    return text + "\n";
  };
  return "POINT_DATA 12\nVECTORS v float\n" + numbers(36, 4) + "COLOR_SCALARS c 4\n" + numbers(48, 1) +
         "LOOKUP_TABLE colours 3\n" + numbers(12, 1) + "FIELD all 2\nw 2 12 double\n" + numbers(24, 8) +
         "METADATA\nINFORMATION 0\n\nramp 1 12 short\n" + (binary ? ramp_bytes(true) : ramp_text()) +
         "\nSCALARS other unsigned_char 1\nLOOKUP_TABLE default\n" + numbers(12, 1);
}

TEST(VtkLegacyTest, OtherArraysArePassedOver) {
  const model::TestFolder folder;
  for (const bool binary : {false, true}) {
    SCOPED_TRACE(binary);
    const auto path = write(folder / "grid.vtk", legacy(binary, kPoints, many_arrays(binary)));
    expect_ramp(path);
    expect_ramp(path, "ramp");
    EXPECT_EQ(fault_of(path, "other"), "");
    EXPECT_THAT(fault_of(path, "v"), HasSubstr("the array v has 3 components"));
    EXPECT_THAT(fault_of(path, "none"), HasSubstr("no array none"));
  }
}

TEST(VtkLegacyTest, TensorsAreReadRowByRow) {
  const model::TestFolder folder;
  Result<GridReader> reader =
      GridReader::open(write(folder / "grid.vtk", legacy(false, "DIMENSIONS 1 1 1\nORIGIN 0 0 0\nSPACING 1 1 1\n",
                                                         "POINT_DATA 1\nTENSORS t float\n1 2 3\n4 5 6\n7 8 9\n")));
  ASSERT_TRUE(reader) << reader.error().message;
  EXPECT_EQ(reader->header().kind, SampleKind::kTensor);
  EXPECT_THAT(testing::read_values(*reader).value(), ElementsAre(1, 2, 3, 4, 5, 6, 7, 8, 9));
}

TEST(VtkLegacyTest, WhatIsNotReadIsNamed) {
  const model::TestFolder folder;
  const auto fault = [&](const std::string& text) { return fault_of(write(folder / "grid.vtk", text)); };
  const std::string head = "# vtk DataFile Version 3.0\nt\n";
  EXPECT_THAT(fault(head + "ASCII\nDATASET POLYDATA\n"), HasSubstr("not a regular grid: DATASET POLYDATA"));
  EXPECT_THAT(fault(head + "HEX\n"), HasSubstr("neither ASCII nor BINARY: hex"));
  EXPECT_THAT(
      fault(legacy(false, kPoints, "POINT_DATA 12\nCOLOR_SCALARS rgb 3\n" + ramp_text() + ramp_text() + ramp_text())),
      HasSubstr("rgb has 3 components"));
  EXPECT_THAT(fault(legacy(false, kPoints, "POINT_DATA 12\nSCALARS a bit\nLOOKUP_TABLE default\n1 1")),
              HasSubstr("type of numbers not supported: bit"));
  EXPECT_THAT(fault(legacy(false, kPoints, "POINT_DATA 5\nSCALARS a short\nLOOKUP_TABLE d\n" + ramp_text())),
              ::testing::AnyOf(HasSubstr("a value for each sample"), HasSubstr("not understood")));
  EXPECT_THAT(fault(legacy(false, "DIMENSIONS 3 -2 2\n", "")), HasSubstr("wrong dimensions"));
  EXPECT_THAT(fault(legacy(false, kPoints, "POINT_DATA 12\n")), HasSubstr("no arrays"));
  EXPECT_THAT(
      fault(legacy(true, kPoints, "POINT_DATA 9223372036854775808\nSCALARS a double\nLOOKUP_TABLE d\n" + ramp_bytes())),
      HasSubstr("truncated"));
  EXPECT_THAT(fault(legacy(false, kPoints, "POINT_DATA 12\nSCALARS a short\nLOOKUP_TABLE d\n1 2 x 4 5 6 7 8 9 1 2 3")),
              HasSubstr("not a number of the samples' type: x"));
}

const std::string kArray = R"(<DataArray type="Int16" Name="ramp" )";

std::string text_array() {
  return kArray + "format=\"ascii\">\n" + ramp_text() + "\n</DataArray>";
}

TEST(VtkXmlTest, EveryCodingIsReadInBothByteOrdersAndWidths) {
  const model::TestFolder folder;
  for (const bool big : {false, true}) {
    for (const bool wide : {false, true}) {
      SCOPED_TRACE(std::string(big ? "big" : "little") + (wide ? " wide" : " narrow"));
      const std::string file = std::string("byte_order=\"") + (big ? "BigEndian" : "LittleEndian") + "\"" +
                               (wide ? " header_type=\"UInt64\"" : " header_type=\"UInt32\"");
      const std::string packed_file = file + " compressor=\"vtkZLibDataCompressor\"";
      const std::string length =
          wide ? packed_numbers(std::vector<uint64_t>{24}, big) : packed_numbers(std::vector<uint32_t>{24}, big);
      const testing::VtkBlocks blocks = testing::vtk_blocks(ramp_bytes(big), wide, big);
      const std::string plain = length + ramp_bytes(big);
      const std::string in_place = kArray + "format=\"binary\">\n  ";
      const std::string appended = kArray + "format=\"appended\" offset=\"4\"/>";
      const auto behind = [](const std::string& encoding, const std::string& data) {
        return "<AppendedData encoding=\"" + encoding + "\">\n   _skip" + data + "\n</AppendedData>";
      };
      const auto expect = [&](const std::string& text) { expect_ramp(write(folder / "grid.vti", text)); };
      expect(vti(file, kVtiExtent, in_place + base64(plain) + "\n</DataArray>"));
      expect(vti(file, kVtiExtent, in_place + base64(length) + base64(ramp_bytes(big)) + "</DataArray>"));
      expect(vti(packed_file, kVtiExtent, in_place + base64(blocks.header) + base64(blocks.blocks) + "</DataArray>"));
      expect(vti(file, kVtiExtent, appended, behind("raw", plain)));
      expect(vti(file, kVtiExtent, appended, behind("base64", base64(plain))));
      expect(vti(packed_file, kVtiExtent, appended, behind("raw", blocks.header + blocks.blocks)));
      expect(vti(packed_file, kVtiExtent, appended, behind("base64", base64(blocks.header) + base64(blocks.blocks))));
    }
  }
}

TEST(VtkXmlTest, ExtentDirectionAndSpacingPlaceSamplesInTheWorld) {
  const model::TestFolder folder;
  std::string text =
      vti("", R"(WholeExtent="0 2 0 1 0 1" Origin="10 20 30" Spacing="1 2 -3" Direction="0 -1 0 1 0 0 0 0 1")",
          text_array());
  const GridHeader header = expect_ramp(write(folder / "a.vti", text));
  EXPECT_EQ(world(header, 1, 0, 0), glm::dvec3(10, 21, 30));  // the first column of the matrix
  EXPECT_EQ(world(header, 0, 1, 1), glm::dvec3(8, 20, 27));
  const std::string from = "\"0 2 0 1 0 1\"";
  for (size_t at = text.find(from); at != std::string::npos; at = text.find(from)) {
    text.replace(at, from.size(), "\"-5 -3 0 1 7 8\"");
  }
  EXPECT_EQ(world(expect_ramp(write(folder / "b.vti", text)), 0, 0, 0), glm::dvec3(10, 15, 9));
}

TEST(VtkXmlTest, TheGridOfCellsIsHalfAStepFurther) {
  const model::TestFolder folder;
  const std::string text =
      "<VTKFile type=\"ImageData\"><ImageData WholeExtent=\"0 3 0 2 0 2\" Spacing=\"2 2 2\"><Piece "
      "Extent=\"0 3 0 2 0 2\"><CellData>" +
      text_array() + "</CellData></Piece></ImageData></VTKFile>";
  EXPECT_EQ(world(expect_ramp(write(folder / "grid.vti", text)), 0, 0, 0), glm::dvec3(1, 1, 1));
}

TEST(VtkXmlTest, ChildrenOfAnArrayAreNotItsNumbers) {
  const model::TestFolder folder;
  const std::string key = "<InformationKey name=\"RANGE\" length=\"2\"><Value index=\"0\">8</Value></InformationKey>";
  expect_ramp(
      write(folder / "a.vti", vti("", kVtiExtent, kArray + "format=\"ascii\">" + ramp_text() + key + "</DataArray>")));
  expect_ramp(write(folder / "b.vti",
                    vti("", kVtiExtent, kArray + "format=\"ascii\">\n" + key + ramp_text() + "</DataArray>")));
}

TEST(VtkXmlTest, TheActiveArrayIsReadUnlessAnotherIsWanted) {
  const model::TestFolder folder;
  const std::string other =
      R"(<DataArray type="UInt8" Name="other" format="ascii">0 1 2 3 4 5 6 7 8 9 10 11</DataArray>)";
  const std::string colors =
      R"(<DataArray type="UInt8" Name="rgb" NumberOfComponents="3" format="ascii">0</DataArray>)";
  const auto path = write(folder / "grid.vti", vti("", kVtiExtent, colors + other + text_array()));
  expect_ramp(path);
  EXPECT_EQ(fault_of(path, "other"), "");
  EXPECT_THAT(fault_of(path, "rgb"), HasSubstr("rgb has 3 components"));
  EXPECT_THAT(fault_of(write(folder / "rgb.vti", vti("", kVtiExtent, colors))), HasSubstr("rgb has 3 components"));
}

TEST(VtkXmlTest, WhatIsNotReadIsNamed) {
  const model::TestFolder folder;
  const auto fault = [&](const std::string& text) { return fault_of(write(folder / "grid.vti", text)); };
  const std::string packed = kArray + "format=\"binary\">AAAA</DataArray>";
  EXPECT_THAT(fault(vti("compressor=\"vtkLZ4DataCompressor\"", kVtiExtent, packed)), HasSubstr("vtkLZ4DataCompressor"));
  EXPECT_THAT(fault("<VTKFile type=\"PolyData\"></VTKFile>"), HasSubstr("not a regular grid: PolyData"));
  EXPECT_THAT(fault("<VTKFile type=\"ImageData\"><ImageData " + kVtiExtent + "></ImageData></VTKFile>"),
              HasSubstr("in 0 pieces"));
  EXPECT_THAT(fault(vti("", R"(WholeExtent="0 9 0 1 0 1")", text_array())), HasSubstr("part of the image"));
  EXPECT_THAT(fault(vti("", R"(WholeExtent="0 -1 0 1 0 1")", text_array())), HasSubstr("without samples"));
  EXPECT_THAT(fault(vti("", kVtiExtent + " Spacing=\"0 1 1\"", text_array())), HasSubstr("do not span space"));
  EXPECT_THAT(fault(vti("", kVtiExtent, kArray + "format=\"appended\" offset=\"0\"/>")),
              HasSubstr("without its appended"));
  EXPECT_THAT(fault(vti("", kVtiExtent, kArray + "format=\"appended\" offset=\"99999\"/>",
                        "<AppendedData encoding=\"raw\">_x</AppendedData>")),
              HasSubstr("beyond the file"));
  EXPECT_THAT(
      fault("<?xml version=\"1.0\"?><!DOCTYPE x [<!ENTITY a \"b\">]>" + vti("", kVtiExtent, text_array()).substr(22)),
      HasSubstr("document type"));
  EXPECT_THAT(fault("<VTKFile type=\"ImageData\"><a></b></VTKFile>"), HasSubstr("damaged XML"));
}

TEST(VtkXmlTest, BlocksThatAreNotAsStatedAreFound) {
  const model::TestFolder folder;
  const std::string file = "compressor=\"vtkZLibDataCompressor\"";
  const auto fault = [&](const std::vector<uint32_t>& header, const std::string& data) {
    return fault_of(write(folder / "grid.vti", vti(file, kVtiExtent,
                                                   kArray + "format=\"binary\">" + base64(packed_numbers(header)) +
                                                       base64(data) + "</DataArray>")));
  };
  const std::string block = testing::zlib(ramp_bytes());
  const auto size = static_cast<uint32_t>(block.size());
  EXPECT_EQ(fault({1, 24, 0, size}, block), "");
  EXPECT_THAT(fault({1000000, 24, 0, size}, block), HasSubstr("states 1000000 blocks"));
  EXPECT_THAT(fault({1, 20, 0, size}, block), HasSubstr("holds at most 20 of 24"));
  EXPECT_THAT(fault({2, 12, 12, size, 0}, block), HasSubstr("larger than stated"));
  EXPECT_THAT(fault({1, 30, 0, size}, block), ::testing::Not(HasSubstr("larger")));  // more than is needed
  EXPECT_THAT(fault({1, 24, 0, size - 6}, block), HasSubstr("truncated"));
  EXPECT_THAT(fault({1, 24, 0, size}, std::string(block.size(), 'x')), HasSubstr("damaged compressed data"));
  EXPECT_THAT(fault({0, 24, 0}, ""), HasSubstr("at most 0 of 24"));
}

}  // namespace
}  // namespace surfcast::grid
