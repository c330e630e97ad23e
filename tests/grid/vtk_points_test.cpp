#include "grid/vtk_points.h"

#include <algorithm>
#include <random>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "grid/grid_files.h"
#include "grid/open_scan.h"
#include "scan/whole_scan.h"
#include "support/packing.h"

namespace surfcast::grid {
namespace {

using testing::base64;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::packed_numbers;
using testing::scalar_values;
using testing::WholeScan;
using testing::write;

/// Three points, and a number of each.
const std::vector<float> kPositions = {0, 0, 0, 1, 2, 3, -4, 5.5F, 6};
const std::vector<int16_t> kHeights = {7, -8, 300};

template <typename T>
std::string text_of(const std::vector<T>& values) {
  std::string text;
  for (const T value : values) text += std::to_string(value) + " ";
  return text;
}

std::string joined(std::initializer_list<std::string_view> parts) {
  std::string all;
  for (const std::string_view part : parts) all += part;
  return all;
}

WholeScan read(const std::filesystem::path& path) {
  const Result<WholeScan> scan = testing::whole(open_scan(path));
  EXPECT_TRUE(scan) << scan.error().message;
  return scan ? *scan : WholeScan();
}

/// The error of a file, which names it, in one line.
std::string fault(const std::filesystem::path& path, const scan::DecodingLimit& limit = {}) {
  const Result<WholeScan> scan = testing::whole(open_scan(path, limit));
  if (scan) return "";
  EXPECT_THAT(scan.error().message, HasSubstr(path.string() + ": "));
  EXPECT_THAT(scan.error().message, ::testing::Not(HasSubstr("\n")));
  return scan.error().message;
}

std::vector<std::string> names_of(const WholeScan& scan) {
  std::vector<std::string> names;
  for (const surfel::ScalarAttribute& scalar : scan.scalars) names.push_back(scalar.name);
  return names;
}

void expect_points(const std::filesystem::path& path) {
  EXPECT_TRUE(holds_vtk_points(path));
  EXPECT_TRUE(check_scan(path));
  const WholeScan scan = read(path);
  EXPECT_THAT(scan.positions, ElementsAre(glm::dvec3(0), glm::dvec3(1, 2, 3), glm::dvec3(-4, 5.5, 6)));
  EXPECT_EQ(scalar_values<int16_t>(scan, "height"), kHeights);
}

// ---- the legacy format

std::string legacy_file(bool binary, const std::string& body, const std::string& version = "4.2") {
  return "# vtk DataFile Version " + version + "\ntitle\n" + (binary ? "BINARY" : "ASCII") + "\nDATASET " + body;
}

/// Numbers as the encoding has them.
template <typename T>
std::string legacy_numbers_of(bool binary, const std::vector<T>& values) {
  return (binary ? packed_numbers(values, true) : text_of(values)) + "\n";
}

std::string legacy_points(bool binary) {
  return "POINTS 3 float\n" + legacy_numbers_of(binary, kPositions);
}

std::string legacy_heights(bool binary) {
  return "POINT_DATA 3\nSCALARS height short 1\nLOOKUP_TABLE default\n" + legacy_numbers_of(binary, kHeights);
}

/// The points in every data set, with whatever may be beside them.
std::vector<std::string> legacy_files(bool binary) {
  const auto ints = [binary](const std::vector<int32_t>& values) { return legacy_numbers_of(binary, values); };
  const auto longs = [binary](const std::vector<int64_t>& values) { return legacy_numbers_of(binary, values); };
  const std::string points = legacy_points(binary);
  const std::string heights = legacy_heights(binary);
  const std::string metadata = "METADATA\nINFORMATION 1\nNAME L2 LOCATION vtkDataArray\nDATA 2 0 9\n\n";
  const std::string offsets = "OFFSETS vtktypeint64\n" + longs({0, 3}) + "CONNECTIVITY vtktypeint64\n";
  return {
      legacy_file(binary, "POLYDATA\n" + points + heights),
      legacy_file(binary, "POLYDATA\n" + points + metadata + "VERTICES 3 6\n" + ints({1, 0, 1, 1, 1, 2}) +
                              "LINES 1 3\n" + ints({2, 0, 1}) + "POLYGONS 1 4\n" + ints({3, 0, 1, 2}) + heights),
      legacy_file(binary, "POLYDATA\n" + points + "POLYGONS 2 3\n" + offsets + longs({0, 1, 2}) + heights, "5.1"),
      legacy_file(binary, "STRUCTURED_GRID\nDIMENSIONS 3 1 1\n" + points + heights, "2.0"),
      legacy_file(binary, "UNSTRUCTURED_GRID\n" + points + "CELLS 1 4\n" + ints({3, 0, 1, 2}) + "CELL_TYPES 1\n" +
                              ints({5}) + "CELL_DATA 1\nSCALARS quality int 1\nLOOKUP_TABLE default\n" + ints({3}) +
                              heights),
      legacy_file(binary,
                  "UNSTRUCTURED_GRID\n" + points + "CELLS 2 3\n" + offsets + longs({0, 1, 2}) + "CELL_TYPES 1\n" +
                      ints({5}) + heights + "FIELD FieldData 1\nid 1 3 vtkIdType\n" + ints({4, 5, 6}) + metadata,
                  "5.1"),
  };
}

TEST(VtkPointsTest, EveryLegacyDataSetWithPointsIsRead) {
  const model::TestFolder folder;
  for (const bool binary : {false, true}) {
    SCOPED_TRACE(binary);
    for (const std::string& file : legacy_files(binary)) {
      SCOPED_TRACE(file.substr(0, 60));
      expect_points(write(folder / "points.vtk", file));
    }
  }
}

TEST(VtkPointsTest, LegacyNormalsColoursAndVectorsHaveTheNamesOfScans) {
  const model::TestFolder folder;
  for (const bool binary : {false, true}) {
    SCOPED_TRACE(binary);
    const std::string colors = binary ? packed_numbers(std::vector<uint8_t>{255, 0, 51, 1, 2, 3, 4, 5, 6}) + "\n"
                                      : std::string("1 0 0.2 0 0 0 0 0 0\n");
    const WholeScan scan =
        read(write(folder / "points.vtk",
                   legacy_file(binary, "POLYDATA\n" + legacy_points(binary) + "POINT_DATA 3\nVECTORS v double\n" +
                                           legacy_numbers_of(binary, std::vector<double>{1, 2, 3, 4, 5, 6, 7, 8, 9}) +
                                           "NORMALS any float\n" +
                                           legacy_numbers_of(binary, std::vector<float>{0, 0, 1, 0, 1, 0, 1, 0, 0}) +
                                           "COLOR_SCALARS tint 3\n" + colors + "TENSORS6 t float\n" +
                                           legacy_numbers_of(binary, std::vector<float>(18, 1)))));
    EXPECT_THAT(names_of(scan), ElementsAre("v_0", "v_1", "v_2", "t_0", "t_1", "t_2", "t_3", "t_4", "t_5"));
    EXPECT_THAT(scalar_values<double>(scan, "v_1"), ElementsAre(2, 5, 8));
    EXPECT_THAT(scan.normals, ElementsAre(glm::vec3(0, 0, 1), glm::vec3(0, 1, 0), glm::vec3(1, 0, 0)));
    ASSERT_TRUE(scan.colors);
    const unsigned full = scan.colors->bits == 8 ? 255 : 65535;
    EXPECT_EQ(glm::uvec3(scan.colors->values[0]), glm::uvec3(full, 0, full / 5));
  }
}

TEST(VtkPointsTest, NamesOfLegacyArraysAreDecoded) {
  const model::TestFolder folder;
  const std::string fields =
      "POINT_DATA 3\nFIELD FieldData 3\nwind%20speed 1 3 int\n1 2 3\n100% 1 3 int\n4 5 6\n%zz%4 1 3 int\n7 8 9\n";
  const WholeScan scan =
      read(write(folder / "points.vtk", legacy_file(false, "POLYDATA\n" + legacy_points(false) + fields)));
  EXPECT_THAT(names_of(scan), ElementsAre("wind speed", "100%", "%zz%4"));
}

TEST(VtkPointsTest, DamagedLegacyFilesAreRefused) {
  const model::TestFolder folder;
  const auto legacy_fault = [&](bool binary, const std::string& body) {
    return fault(write(folder / "points.vtk", legacy_file(binary, body)));
  };
  for (const bool binary : {false, true}) {
    const std::string points = legacy_points(binary);
    EXPECT_THAT(legacy_fault(binary, "POLYDATA\n" + points.substr(0, points.size() - 12)), HasSubstr("truncated"));
    for (const char* count : {"4", "6148914691236517206", "18446744073709551615"}) {
      const std::string more = std::string("POINTS ") + count + points.substr(8);
      EXPECT_THAT(legacy_fault(binary, "POLYDATA\n" + more), HasSubstr("truncated")) << count;
    }
    const std::string heights = legacy_numbers_of(binary, std::vector<int16_t>{1, 2});
    const std::string data = "POINT_DATA 2\nSCALARS height short\nLOOKUP_TABLE default\n";
    EXPECT_THAT(legacy_fault(binary, joined({"POLYDATA\n", points, data, heights})),
                HasSubstr("the array height has 2 values for 3 points"));
    EXPECT_THAT(legacy_fault(binary, "POLYDATA\nPOINTS 0 float\n"), HasSubstr("has no points"));
    EXPECT_THAT(legacy_fault(binary, "UNSTRUCTURED_GRID\n"), HasSubstr("has no points"));
    EXPECT_THAT(legacy_fault(binary, "POLYDATA\nPOINTS 1 complex\n"), HasSubstr("type of numbers not supported"));
    EXPECT_THAT(legacy_fault(binary, "POLYDATA\n" + points + "WHAT 1 2\n"), HasSubstr("line not understood: WHAT"));
  }
  EXPECT_THAT(legacy_fault(false, "POLYDATA\nPOINTS 1 float\n1 2 three\n"),
              HasSubstr("coordinates: not a number of the samples' type: three"));
  EXPECT_THAT(legacy_fault(true, "POLYDATA\nPOINTS 1 float\n" + packed_numbers(std::vector<float>{1, 2, 3}, true) +
                                     "\nPOINT_DATA 1\nSCALARS s float 2000000000000000000\nLOOKUP_TABLE default\n1"),
              HasSubstr("truncated"));
}

// ---- the XML format

/// How the numbers of an XML file are written.
struct Coding {
  std::string format;  ///< of the arrays
  std::string appended;
  bool packed = false;
  bool wide = false;
  bool big = false;

  [[nodiscard]] std::string name() const {
    return format + appended + (packed ? " packed" : "") + (wide ? " wide" : "") + (big ? " big" : "");
  }
};

std::vector<Coding> codings() {
  std::vector<Coding> all = {{"ascii", "", false, false, false}};
  for (const char* appended : {"", "raw", "base64"}) {
    for (int bits = 0; bits < 8; ++bits) {
      all.push_back(
          {*appended == 0 ? "binary" : "appended", appended, (bits & 1) != 0, (bits & 2) != 0, (bits & 4) != 0});
    }
  }
  return all;
}

/// An XML file, array by array.
class XmlWriter {
 public:
  explicit XmlWriter(Coding coding) : coding_(std::move(coding)) {}

  /// An array; `attributes`: name and number of components.
  template <typename T>
  std::string array(const std::string& type, const std::string& attributes, const std::vector<T>& values) {
    const std::string tag = "<DataArray type=\"" + type + "\" " + attributes + " format=\"" + coding_.format + "\"";
    if (coding_.format == "ascii") return tag + ">\n" + text_of(values) + "\n</DataArray>\n";
    const std::string numbers = stored(packed_numbers(values, coding_.big));
    if (coding_.format == "binary") return tag + ">\n" + numbers + "\n</DataArray>\n";
    const std::string offset = std::to_string(data_.size());
    data_ += numbers;
    return tag + " offset=\"" + offset + "\"/>\n";
  }

  [[nodiscard]] std::string file(const std::string& type, const std::string& pieces) const {
    std::string text = "<?xml version=\"1.0\"?>\n<VTKFile type=\"" + type + "\" version=\"1.0\" byte_order=\"" +
                       (coding_.big ? "BigEndian" : "LittleEndian") + "\" header_type=\"" +
                       (coding_.wide ? "UInt64" : "UInt32") + "\"" +
                       (coding_.packed ? " compressor=\"vtkZLibDataCompressor\"" : "") + ">\n<" + type + ">\n" +
                       pieces + "</" + type + ">\n";
    if (!coding_.appended.empty()) {
      text += "<AppendedData encoding=\"" + coding_.appended + "\">\n_" + data_ + "\n</AppendedData>\n";
    }
    return text + "</VTKFile>\n";
  }

 private:
  [[nodiscard]] std::string stored(const std::string& bytes) const {
    const bool raw = coding_.appended == "raw";
    const auto encoded = [raw](const std::string& text) { return raw ? text : base64(text); };
    if (coding_.packed) {
      const testing::VtkBlocks blocks = testing::vtk_blocks(bytes, coding_.wide, coding_.big);
      return encoded(blocks.header) + encoded(blocks.blocks);
    }
    const std::string size = coding_.wide
                                 ? packed_numbers(std::vector<uint64_t>{bytes.size()}, coding_.big)
                                 : packed_numbers(std::vector{static_cast<uint32_t>(bytes.size())}, coding_.big);
    return encoded(size + bytes);
  }

  Coding coding_;
  std::string data_;
};

const std::string kThree = "NumberOfComponents=\"3\"";

std::string piece(const std::string& attributes, const std::string& arrays, const std::string& points) {
  return "<Piece " + attributes + ">\n<PointData>\n" + arrays + "</PointData>\n<Points>\n" + points +
         "</Points>\n</Piece>\n";
}

/// A file as text with these arrays of three points.
std::string text_file(const std::string& arrays, const std::string& attributes = "NumberOfPoints=\"3\"") {
  XmlWriter writer({"ascii", "", false, false, false});
  return writer.file("PolyData", piece(attributes, arrays, writer.array("Float32", kThree, kPositions)));
}

std::string data_array(const std::string& attributes, const std::string& numbers) {
  return "<DataArray " + attributes + " format=\"ascii\">" + numbers + "</DataArray>\n";
}

TEST(VtkPointsTest, EveryCodingOfXmlIsReadInBothByteOrdersAndWidths) {
  const model::TestFolder folder;
  for (const Coding& coding : codings()) {
    SCOPED_TRACE(coding.name());
    for (const auto& [type, attributes] : {std::pair{"PolyData", R"(NumberOfPoints="3" NumberOfVerts="3")"},
                                           {"UnstructuredGrid", R"(NumberOfPoints="3" NumberOfCells="0")"},
                                           {"StructuredGrid", R"(Extent="4 6 0 0 -1 -1")"}}) {
      XmlWriter writer(coding);
      const std::string heights = writer.array("Int16", "Name=\"height\"", kHeights);
      const std::string points = writer.array("Float32", kThree, kPositions);
      expect_points(write(folder / "points.vtp", writer.file(type, piece(attributes, heights, points))));
    }
  }
}

TEST(VtkPointsTest, PiecesFollowEachOther) {
  const model::TestFolder folder;
  for (const Coding& coding : codings()) {
    SCOPED_TRACE(coding.name());
    XmlWriter writer(coding);
    const auto part = [&writer](const std::vector<double>& positions, const std::vector<uint8_t>& labels) {
      return piece("NumberOfPoints=\"" + std::to_string(labels.size()) + "\"",
                   writer.array("UInt8", "Name=\"label\"", labels), writer.array("Float64", kThree, positions));
    };
    const std::string empty = "<Piece NumberOfPoints=\"0\"><PointData/><Points/></Piece>\n";
    const std::string pieces = joined({empty, part({1, 0, 0, 2, 0, 0}, {1, 2}), empty, part({3, 0, 0}, {3})});
    const WholeScan scan = read(write(folder / "points.vtu", writer.file("UnstructuredGrid", pieces)));
    EXPECT_THAT(scan.positions, ElementsAre(glm::dvec3(1, 0, 0), glm::dvec3(2, 0, 0), glm::dvec3(3, 0, 0)));
    EXPECT_THAT(scalar_values<uint8_t>(scan, "label"), ElementsAre(1, 2, 3));
  }
}

TEST(VtkPointsTest, ArraysThatNotAllPiecesHaveAreLeftOutAndNamed) {
  const model::TestFolder folder;
  const auto part = [](const std::string& arrays) {
    return piece("NumberOfPoints=\"1\"", arrays, data_array("type=\"Float32\" " + kThree, "1 2 3"));
  };
  const std::string one = data_array(R"(type="Int32" Name="a1")", "1") + data_array(R"(type="Int32" Name="b1")", "2") +
                          data_array(R"(type="Int32" Name="c1")", "3");
  const std::string other =
      data_array(R"(type="Float32" Name="c1")", "4") + data_array(R"(type="Int32" Name="b1")", "5");
  const XmlWriter writer({"ascii", "", false, false, false});
  const auto path = write(folder / "points.vtp", writer.file("PolyData", part(one) + part(other)));
  const WholeScan scan = read(path);
  EXPECT_THAT(names_of(scan), ElementsAre("b1"));
  EXPECT_THAT(scalar_values<int32_t>(scan, "b1"), ElementsAre(2, 5));
  EXPECT_THAT(open_scan(path).value().schema().notes,
              ElementsAre("arrays are left out: a1, which is not in all pieces; c1, which is not in all pieces"));
}

TEST(VtkPointsTest, ActiveArraysAndNamesTellNormalsAndColours) {
  const model::TestFolder folder;
  const auto normals = [](const std::string& name) {
    return data_array("type=\"Float32\" Name=\"" + name + "\" " + kThree, "0 0 1 0 1 0 1 0 0");
  };
  const auto colors = [](const std::string& name) {
    return data_array("type=\"UInt8\" Name=\"" + name + "\" NumberOfComponents=\"4\"", "9 8 7 6 5 4 3 2 1 0 255 254");
  };
  const auto scan_of = [&](std::string text, const std::string& active) {
    text.replace(text.find("<PointData>"), 11, "<PointData " + active + ">");
    return read(write(folder / "points.vtp", text));
  };
  WholeScan scan = scan_of(text_file(normals("Normals") + colors("RGBA")), "");
  EXPECT_EQ(scan.normals.at(1), glm::vec3(0, 1, 0));
  EXPECT_EQ(scan.colors.value().values.at(2), glm::u16vec3(1, 0, 255));
  EXPECT_THAT(scalar_values<uint8_t>(scan, "alpha"), ElementsAre(6, 2, 254));

  scan = scan_of(text_file(normals("Normals") + normals("N") + colors("rgb") + colors("other")),
                 R"(Normals="N" Scalars="other")");
  EXPECT_THAT(names_of(scan),
              ElementsAre("Normals_0", "Normals_1", "Normals_2", "rgb_0", "rgb_1", "rgb_2", "rgb_3", "alpha"));
  EXPECT_EQ(scan.normals.size(), 3U);
  EXPECT_TRUE(scan.colors);

  scan = scan_of(text_file(normals("N") + colors("other")), "");
  EXPECT_TRUE(scan.normals.empty());
  EXPECT_FALSE(scan.colors);
  EXPECT_EQ(scan.scalars.size(), 7U);
}

TEST(VtkPointsTest, NamesThatScansHaveForOtherThingsAreKeptApart) {
  const model::TestFolder folder;
  const std::string heights = text_of(kHeights);
  const WholeScan scan = read(write(
      folder / "points.vtp",
      text_file(data_array(R"(type="Int16" Name="x")", heights) + data_array(R"(type="Int16" Name="a b")", heights) +
                data_array(R"(type="Int16" Name="a b")", heights) + data_array(R"(type="Int16")", heights))));
  EXPECT_EQ(scan.positions.at(1), glm::dvec3(1, 2, 3));
  EXPECT_THAT(names_of(scan), ElementsAre("x_2", "a b", "a b_2", "values"));
}

TEST(VtkPointsTest, CellsTheirDataAndTextsAreLeftOutWithANote) {
  const model::TestFolder folder;
  const std::string arrays =
      data_array(R"(type="String" Name="label")", "65 0") + data_array(R"(type="Int16" Name="height")", "7 -8 300");
  std::string text = text_file(arrays, R"(NumberOfPoints="3" NumberOfVerts="3" NumberOfPolys="1")");
  const std::string cells = "<CellData>" + data_array(R"(type="Int16" Name="quality")", "5") + "</CellData><Polys>" +
                            data_array(R"(type="Int64" Name="connectivity")", "0 1 2") + "</Polys>";
  text.insert(text.find("</Piece>"), cells);
  const auto path = write(folder / "points.vtp", text);
  expect_points(path);
  EXPECT_THAT(
      open_scan(path).value().schema().notes,
      ElementsAre(HasSubstr("cells are left out"), "arrays are left out: label of type String; quality of the cells"));
  EXPECT_THAT(open_scan(write(folder / "bare.vtp", text_file(""))).value().schema().notes, IsEmpty());
}

TEST(VtkPointsTest, DamagedXmlFilesAreRefused) {
  const model::TestFolder folder;
  const auto xml_fault = [&](const std::string& text) { return fault(write(folder / "points.vtp", text)); };
  const std::string good = text_file(data_array(R"(type="Int16" Name="height")", "7 -8 300"));
  EXPECT_EQ(xml_fault(good), "");
  const auto changed = [&good](const std::string& from, const std::string& to) {
    std::string text = good;
    text.replace(text.find(from), from.size(), to);
    return text;
  };
  EXPECT_THAT(xml_fault(good.substr(0, good.size() / 2)), HasSubstr("damaged XML"));
  EXPECT_THAT(xml_fault(changed("=\"3\"", "=\"4\"")), HasSubstr("coordinates: "));
  EXPECT_THAT(xml_fault(changed("=\"3\"", "=\"18446744073709551615\"")), HasSubstr("truncated"));
  EXPECT_THAT(xml_fault(changed("=\"3\"", "=\"many\"")), HasSubstr("no number of points in a piece: many"));
  EXPECT_THAT(xml_fault(changed("=\"3\"", "=\"0\"")), HasSubstr("has no points"));
  EXPECT_THAT(xml_fault(changed("NumberOfComponents=\"3\"", "NumberOfComponents=\"2\"")),
              HasSubstr("without three coordinates"));
  EXPECT_THAT(xml_fault(changed("-8", "x")), HasSubstr("height: not a number"));
  EXPECT_THAT(xml_fault(changed("-8", "")), HasSubstr("height: truncated"));
  EXPECT_THAT(xml_fault(changed("Name=\"height\"", "Name=\"height\" NumberOfComponents=\"0\"")),
              HasSubstr("the array height has no components"));
  EXPECT_THAT(xml_fault(changed("Name=\"height\"", "Name=\"height\" NumberOfComponents=\"4000000000\"")),
              HasSubstr("more than 1024 values for each point"));
  EXPECT_THAT(xml_fault(changed("Points>", "Pints>")), HasSubstr("damaged XML"));
  const XmlWriter writer({"ascii", "", false, false, false});
  EXPECT_THAT(xml_fault(writer.file("PolyData", piece("NumberOfPoints=\"3\"", "", ""))),
              HasSubstr("points without coordinates"));
  EXPECT_THAT(xml_fault(writer.file("PolyData", "")), HasSubstr("has no points"));
  EXPECT_THAT(xml_fault(writer.file("StructuredGrid", piece(R"(Extent="0 2147483647 0 2147483647 0 2147483647")", "",
                                                            data_array("type=\"Float32\" " + kThree, "1 2 3")))),
              HasSubstr("truncated"));
}

TEST(VtkPointsTest, CountsBeyondTheFileTakeNoMemory) {
  const model::TestFolder folder;
  for (const Coding& coding : codings()) {
    SCOPED_TRACE(coding.name());
    for (const char* count : {"4", "1000000000", "6148914691236517206", "18446744073709551615"}) {
      XmlWriter writer(coding);
      const std::string points = writer.array("Float32", kThree, kPositions);
      const std::string part = piece(std::string("NumberOfPoints=\"") + count + "\"", "", points);
      EXPECT_THAT(fault(write(folder / "points.vtp", writer.file("PolyData", part))),
                  ::testing::AnyOf(HasSubstr("truncated"), HasSubstr("end too early")));
    }
  }
}

TEST(VtkPointsTest, EveryPrefixOfAFileIsRefused) {
  const model::TestFolder folder;
  for (const Coding& coding : {Coding{"appended", "raw", true, false, false}, Coding{"appended", "raw"},
                               Coding{"appended", "base64", true}, Coding{"binary", ""}}) {
    SCOPED_TRACE(coding.name());
    XmlWriter writer(coding);
    const std::string heights = writer.array("Int16", "Name=\"height\"", kHeights);
    const std::string points = writer.array("Float32", kThree, kPositions);
    const std::string text = writer.file("PolyData", piece("NumberOfPoints=\"3\"", heights, points));
    const size_t needed = text.rfind(coding.format == "appended" ? "\n</AppendedData>" : "</VTKFile>");
    for (size_t size = 100; size < needed; ++size) {
      EXPECT_NE(fault(write(folder / "points.vtp", text.substr(0, size))), "") << size;
    }
  }
}

TEST(VtkPointsTest, DamagedFilesGivePointsOrAnErrorThatNamesThem) {
  const model::TestFolder folder;
  std::mt19937 random(11);
  std::vector<std::string> files = {legacy_file(false, "POLYDATA\n" + legacy_points(false) + legacy_heights(false)),
                                    legacy_file(true, "POLYDATA\n" + legacy_points(true) + legacy_heights(true))};
  for (const Coding& coding : codings()) {
    XmlWriter writer(coding);
    const std::string heights = writer.array("Int16", "Name=\"height\"", kHeights);
    const std::string points = writer.array("Float32", kThree, kPositions);
    files.push_back(writer.file("PolyData", piece("NumberOfPoints=\"3\"", heights, points)));
  }
  for (const std::string& file : files) {
    for (int round = 0; round < 100; ++round) {
      std::string text = file;
      // A digit for a digit reaches further than any byte.
      for (int i = 0; i < 3; ++i) {
        char& c = text[random() % text.size()];
        const bool digit = c >= '0' && c <= '9';
        c = digit ? static_cast<char>('0' + random() % 10) : static_cast<char>(random());
        if (i == 0 && random() % 2 == 0) break;
      }
      fault(write(folder / "points.vtp", text), {size_t{1} << 26});
    }
  }
}

TEST(VtkPointsTest, WhatIsDecodedAsAWholeMustFitIntoTheMemory) {
  const model::TestFolder folder;
  for (const Coding& coding : codings()) {
    SCOPED_TRACE(coding.name());
    XmlWriter writer(coding);
    const std::string heights = writer.array("Int16", "Name=\"height\"", kHeights);
    const std::string points = writer.array("Float32", kThree, kPositions);
    const auto path =
        write(folder / "points.vtp", writer.file("PolyData", piece("NumberOfPoints=\"3\"", heights, points)));
    const bool in_file = coding.appended == "raw" && !coding.packed;
    EXPECT_EQ(fault(path, {42}), "");
    if (in_file) {
      EXPECT_EQ(fault(path, {0}), "");
    } else {
      EXPECT_THAT(fault(path, {41}), HasSubstr("height: can only be decoded whole"));
    }
    EXPECT_EQ(open_scan(path).value().held_bytes(), in_file ? 0U : 42U);
  }
}

TEST(VtkPointsTest, OtherCompressionsAreRefusedByName) {
  const model::TestFolder folder;
  for (const char* compressor : {"vtkLZ4DataCompressor", "vtkLZMADataCompressor"}) {
    XmlWriter writer({"binary", "", true, false, false});
    const std::string points = writer.array("Float32", kThree, kPositions);
    std::string text = writer.file("PolyData", piece("NumberOfPoints=\"3\"", "", points));
    text.replace(text.find("vtkZLibDataCompressor"), 21, compressor);
    EXPECT_THAT(fault(write(folder / "points.vtp", text)),
                HasSubstr(std::string("the compression is not supported: ") + compressor));
  }
}

TEST(VtkPointsTest, LargeSetsAreReadInSlices) {
  const model::TestFolder folder;
  constexpr size_t kCount = scan::kPieceRows + 5;
  std::vector<float> positions(3 * kCount);
  for (size_t i = 0; i < kCount; ++i) positions[3 * i] = static_cast<float>(i);
  for (const Coding& coding : {Coding{"appended", "raw"}, Coding{"binary", ""}}) {
    XmlWriter writer(coding);
    const std::string points = writer.array("Float32", kThree, positions);
    const std::string part = piece("NumberOfPoints=\"" + std::to_string(kCount) + "\"", "", points);
    const auto path = write(folder / "points.vtp", writer.file("PolyData", part));
    EXPECT_EQ(open_scan(path).value().pieces(), 2U);
    const WholeScan scan = read(path);
    ASSERT_EQ(scan.size(), kCount);
    for (size_t i = 0; i < kCount; ++i) ASSERT_EQ(scan.positions[i].x, static_cast<double>(i));
  }
}

TEST(VtkPointsTest, APartOfThePointsMayBeSelectedOrSampled) {
  const model::TestFolder folder;
  const auto path =
      write(folder / "points.vtp", text_file(data_array(R"(type="UInt8" Name="Classification")", "2 6 2")));
  scan::Selection ground;
  ground.classes = {2};
  EXPECT_EQ(open_scan(path, {}, {}, ground).value().size(), 2U);
  ground.classes = {9};
  EXPECT_THAT(open_scan(path, {}, {}, ground).error().message, HasSubstr("points.vtp: has no points in the selection"));
  EXPECT_EQ(open_scan(path, {}, 1).value().size_of_file(), 3U);
}

TEST(VtkPointsTest, OtherFilesAreLeftToOtherReaders) {
  const model::TestFolder folder;
  for (const char* other : {"# vtk DataFile Version 3.0\nt\nASCII\nDATASET STRUCTURED_POINTS\n",
                            "<VTKFile type=\"ImageData\">", "<VTKFile type=\"PPolyData\">", "<VTKFile", "# vtk", ""}) {
    EXPECT_FALSE(holds_vtk_points(write(folder / "other.vtk", other))) << other;
  }
  EXPECT_FALSE(holds_vtk_points(folder / "missing.vtp"));
  EXPECT_FALSE(holds_vtk_points(folder / ""));
  EXPECT_EQ(read(write(folder / "scan.xyz", "1 2 3\n4 5 6\n")).size(), 2U);
}

}  // namespace
}  // namespace surfcast::grid
