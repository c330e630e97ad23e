// Whatever happens to the bytes of a scan, its reader returns points or an error, within bounds of time and memory. A
// separate program, because it counts all allocated memory.

#include <algorithm>
#include <array>
#include <cctype>
#include <ctime>
#include <fstream>
#include <functional>
#include <limits>
#include <map>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include "model/counted_memory.h"
#include "model/test_folder.h"
#include "scan/copc_file.h"
#include "scan/e57_scans.h"
#include "scan/folder_files.h"
#include "scan/samples.h"
#include "scan/tile_files.h"
#include "scan/whole_scan.h"
#include "support/path_of.h"
#include "support/sample_size.h"

namespace surfcast::scan {
namespace {

namespace fs = std::filesystem;
using testing::GltfFile;
using Files = std::map<std::string, std::string>;
using Random = std::mt19937;

constexpr DecodingLimit kLimit{uint64_t{64} << 20};
/// The limit is for what is decoded at once; a copy of it may be under way to the caller.
constexpr size_t kMaxMemory = 2 * kLimit.max_bytes + (size_t{16} << 20);

/// A scan in one file or several.
struct Scan {
  std::string name;
  Files files;
  std::string opened;                                   ///< of several files: the one that is opened; else the folder
  std::function<void(std::string&, Random&)> repair{};  ///< makes checksums right again, as an attacker would
  Selection selection{};

  [[nodiscard]] bool in_memory() const { return files.size() == 1 && opened.empty(); }
};

void PrintTo(const Scan& scan, std::ostream* to) {
  *to << scan.name;
}

// ---- scans

std::string content_of_laz(const std::string& name) {
  const std::vector<char> bytes = model::read_bytes(fs::path(path_of("tests/data")) / "laz" / name);
  return {bytes.begin(), bytes.end()};
}

std::string expe() {
  testing::Bytes file(
      "[Expe/PointSet/Binary/0.1]\nproperty position 12\nproperty radius 4\nproperty normal 12\n"
      "property color 4\nnofpoints 3\ndata\n");
  for (const float at : {1.0F, 2.0F, 4.0F}) {
    file.add(at).add(0.5F).add(-at).add(0.25F).add(0.0F).add(0.0F).add(1.0F).add(uint32_t{0xFF102030});
  }
  return file.text();
}

std::string quantised_pnts() {
  const std::string bytes =
      std::string(12, '\x7F') + std::string(4, '\x21') + std::string(4, '\x90') + std::string("\1\0", 2);
  return testing::pnts(
      R"({"POINTS_LENGTH": 2, "BATCH_LENGTH": 2, "RTC_CENTER": [1e6, 0, 0], "POSITION_QUANTIZED": {"byteOffset": 0},
    "QUANTIZED_VOLUME_OFFSET": [1, 2, 3], "QUANTIZED_VOLUME_SCALE": [10, 10, 10], "RGB565": {"byteOffset": 12},
    "NORMAL_OCT16P": {"byteOffset": 16}, "BATCH_ID": {"byteOffset": 20, "componentType": "UNSIGNED_BYTE"}})",
      bytes, R"({"height": {"byteOffset": 0, "componentType": "UNSIGNED_SHORT", "type": "SCALAR"}})",
      std::string("\1\0\2\0", 4));
}

std::string draco_pnts() {
  const std::string cloud = testing::draco_cloud(false);
  const nlohmann::json packed = {
      {"byteOffset", 0}, {"byteLength", cloud.size()}, {"properties", {{"POSITION", 0}, {"RGB", 1}}}};
  const nlohmann::json features = {{"POINTS_LENGTH", 300},
                                   {"POSITION", {{"byteOffset", 0}}},
                                   {"RGB", {{"byteOffset", 0}}},
                                   {"extensions", {{"3DTILES_draco_point_compression", packed}}}};
  return testing::pnts(features.dump(), cloud);
}

GltfFile gltf() {
  GltfFile file = GltfFile().positions({1, 2, 3, 4, 5, 6, 7, 8, 9});
  file.add<uint8_t>("COLOR_0", 5121, "VEC4", 3, {255, 0, 9, 255, 1, 2, 3, 255, 4, 5, 6, 255}, true);
  file.add<int8_t>("NORMAL", 5120, "VEC3", 3, {0, 127, 0, 0, 0, -127, 127, 0, 0}, true);
  file.add<uint16_t>("_INTENSITY", 5123, "SCALAR", 3, {1, 2, 3});
  file.add<uint8_t>("unused", 5121, "SCALAR", 3, {2, 0, 1});
  file.primitive()["indices"] = file.primitive()["attributes"]["unused"];
  file.primitive()["attributes"].erase("unused");
  return file;
}

Files ept(const std::string& type, const std::string& extension,
          const std::function<std::string(const std::string&)>& pack) {
  Files files;
  testing::write_ept([&files](const std::string& name, const std::string& text) { files[name] = text; }, type,
                     extension, pack);
  return files;
}

Files potree1() {
  return {{"cloud.js", testing::cloud_js(R"("hierarchyStepSize": 1)")},
          {"data/r/r.hrc", testing::hrc_entry(1 << 4, 1) + testing::hrc_entry(1 << 1, 1)},
          {"data/r/4/r4.hrc", testing::hrc_entry(1 << 1, 1) + testing::hrc_entry(0, 1)},
          {"data/r/r.bin", testing::bin_point(1, 2, 3)},
          {"data/r/4/r4.bin", testing::bin_point(1, 2, 3)},
          {"data/r/4/1/r41.bin", testing::bin_point(1, 2, 3)}};
}

Files potree2(bool brotli) {
  const std::string first = brotli ? testing::brotli_node(1 << 20, 7, 400) : testing::point2(1 << 20, 7, 400);
  const std::string second = brotli ? testing::brotli_node(4, 8, 1) : testing::point2(4, 8, 1);
  std::string text = testing::metadata(brotli ? "BROTLI" : "DEFAULT");
  text.replace(text.find("44"), 2, "66");
  return {{"metadata.json", text},
          {"hierarchy.bin", testing::node2(0, 0b101, 1, 0, first.size()) + testing::node2(2, 0, 1, 66, 22) +
                                testing::node2(1, 0, 9, 0, 0) + testing::node2(1, 0, 1, first.size(), second.size())},
          {"octree.bin", first + second}};
}

Files tileset() {
  const GltfFile file = gltf();
  return {{"tileset.json", R"({"asset": {"version": "1.1"}, "root": {"refine": "ADD", "transform": [1, 0, 0, 0, 0, 1,
    0, 0, 0, 0, 1, 0, 10, 0, 0, 1], "content": {"uri": "a.pnts"}, "children": [{"content": {"uri": "b.glb"}},
    {"contents": [{"uri": "sub/c.json"}, {"uri": "d.gltf"}]}]}})"},
          {"sub/c.json", R"({"asset": {"version": "1.0"}, "root": {"content": {"uri": "e.b3dm"}}})"},
          {"sub/e.b3dm", "b3dm" + testing::pnts(R"({"RTC_CENTER": [1, 2, 3]})", "").substr(4) + file.binary()},
          {"a.pnts", testing::one_point(1)},
          {"b.glb", testing::draco_points().binary()},
          {"d.gltf", file.text("d.bin")},
          {"d.bin", file.bytes}};
}

void repair_e57(std::string& file, Random& /*unused*/) {
  for (size_t at = 0; at + testing::E57File::kPage <= file.size(); at += testing::E57File::kPage) {
    testing::mend(file, at);
  }
}

std::vector<Scan> all_scans() {
  std::vector<Scan> scans;
  const auto add_file = [&scans](const std::string& name, const std::string& text) {
    scans.push_back({name, {{name, text}}, {}});
  };
  for (const testing::Sample& sample : testing::samples()) add_file(sample.name, sample.text);
  for (const char* name : {"indoor.laz", "lion.laz", "random-rgb-nir.laz"}) add_file(name, content_of_laz(name));
  add_file("points.expe.pts", expe());
  add_file("checked.e57", testing::two_scans());
  add_file("quantised.pnts", quantised_pnts());
  add_file("draco.pnts", draco_pnts());
  add_file("points.glb", gltf().binary());
  add_file("draco.glb", testing::draco_points().binary());
  add_file("meshopt.glb", testing::meshopt_points().binary());
  scans.push_back({"repaired.e57", {{"repaired.e57", testing::two_scans()}}, {}, repair_e57});
  Scan copc{"copc.laz", {{"copc.laz", testing::copc_file({3, 5, 2})}}, "copc.laz"};
  geometry::Box box;
  box.min = {0, 0, -1};
  box.max = {200, 200, 1};
  copc.selection.zone.boxes = {box};
  scans.push_back(copc);
  const auto plain = [](const std::string& text) { return text; };
  scans.push_back({"ept_binary", ept("binary", ".bin", plain), {}});
  scans.push_back({"ept_zstandard", ept("zstandard", ".zst", testing::zstd_of), {}});
  scans.push_back({"potree1", potree1(), {}});
  scans.push_back({"potree2", potree2(false), {}});
  scans.push_back({"potree2_brotli", potree2(true), {}});
  scans.push_back({"tileset", tileset(), {}});
  scans.push_back({"implicit_tileset", testing::quadtree_files("ADD"), {}});
  return scans;
}

// ---- damage

size_t below(Random& random, size_t end) {
  return end == 0 ? 0 : random() % end;
}

void flip_bits(std::string& file, Random& random) {
  for (auto flips = 1 + random() % 3; flips > 0; --flips) {
    char& byte = file[below(random, file.size())];
    byte = static_cast<char>(byte ^ 1 << random() % 8);
  }
}

void change_bytes(std::string& file, Random& random) {
  for (auto changes = 1 + random() % 4; changes > 0; --changes) {
    file[below(random, file.size())] = static_cast<char>(random());
  }
}

void truncate(std::string& file, Random& random) {
  file.resize(below(random, file.size()));
}

/// Numbers at which readers go wrong: none, one, the largest of each width, and those beside them.
constexpr std::array<uint64_t, 14> kExtremes{0,
                                             1,
                                             0x7F,
                                             0x80,
                                             0xFF,
                                             0x7FFF,
                                             0xFFFF,
                                             0x7FFFFFFF,
                                             0x80000000,
                                             0xFFFFFFFF,
                                             0xFFFFFFFE,
                                             0x7FFFFFFFFFFFFFFF,
                                             uint64_t{1} << 40,
                                             0xFFFFFFFFFFFFFFFF};

/// Overwrites a number in binary: a length, a count, an offset, wherever one may lie.
void change_length(std::string& file, Random& random) {
  const size_t width = size_t{1} << random() % 4;
  if (file.size() < width) return;
  std::string bytes = testing::Bytes().add(kExtremes[random() % kExtremes.size()]).text().substr(0, width);
  if (random() % 4 == 0) std::reverse(bytes.begin(), bytes.end());
  file.replace(below(random, file.size() - width + 1), width, bytes);
}

/// Another number for one in text.
void change_number(std::string& file, Random& random) {
  const auto digit = [&file](size_t at) { return std::isdigit(static_cast<unsigned char>(file[at])) != 0; };
  size_t first = below(random, file.size());
  while (first < file.size() && !digit(first)) ++first;
  size_t end = first;
  while (end < file.size() && digit(end)) ++end;
  if (first == end) return;
  const std::string number = std::to_string(kExtremes[random() % kExtremes.size()]);
  file.replace(first, end - first, random() % 4 == 0 ? "-" + number : number);
}

void repeat_or_remove(std::string& file, Random& random) {
  const size_t at = below(random, file.size());
  const size_t size = 1 + below(random, std::min<size_t>(file.size() - at, 64));
  if (random() % 2 == 0) {
    file.erase(at, size);
  } else {
    file.insert(at, file.substr(at, size));
  }
}

void damage(std::string& file, Random& random) {
  constexpr std::array kKinds{flip_bits, change_bytes, truncate, change_length, change_number, repeat_or_remove};
  if (!file.empty()) kKinds[random() % kKinds.size()](file, random);
}

// ---- reading

double processor_seconds() {
  timespec t{};
  ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + static_cast<double>(t.tv_nsec) * 1e-9;
}

/// Reads all pieces, and keeps none.
Status read_all(const Result<ScanStream>& stream) {
  if (!stream) return fail(stream);
  for (size_t piece = 0; piece < stream->pieces(); ++piece) {
    const Result<ScanPoints> points = stream->read(piece);
    if (!points) return fail(points);
    EXPECT_TRUE(points->normals.empty() || points->normals.size() == points->size());
    EXPECT_TRUE(!points->colors || points->colors->values.size() == points->size());
  }
  return {};
}

void expect_one_line_for_people(const Error& error, const std::string& name) {
  const bool typed = error.kind == ErrorKind::kInvalidInput || error.kind == ErrorKind::kUnsupported ||
                     error.kind == ErrorKind::kLimit || error.kind == ErrorKind::kNotFound;
  EXPECT_TRUE(typed) << error.message;
  EXPECT_NE(error.message.find(name), std::string::npos) << error.message;
  EXPECT_TRUE(std::none_of(error.message.begin(), error.message.end(), [](unsigned char c) { return c < ' '; }))
      << error.message;
}

class DamagedScanTest : public ::testing::TestWithParam<Scan> {
 protected:
  DamagedScanTest() {
    if (GetParam().in_memory()) return;
    for (const auto& [name, text] : GetParam().files) write(name, text);
  }
  void write(const std::string& name, const std::string& text) const {
    const fs::path path = folder_ / name.c_str();
    fs::create_directories(path.parent_path());
    std::ofstream(path, std::ios::binary) << text;
  }
  /// The scan, one of its files having this text.
  [[nodiscard]] Status read(const std::string& name, const std::string& text) const {
    if (GetParam().in_memory()) {
      const std::vector<std::byte> exact(testing::as_bytes(text).begin(), testing::as_bytes(text).end());
      return read_all(ScanStream::open_content(exact, name, kLimit));
    }
    write(name, text);
    const fs::path path = folder_ / GetParam().opened.c_str();
    return read_all(ScanStream::open(path, kLimit, {}, GetParam().selection));
  }
  /// The name that errors have in any case.
  [[nodiscard]] std::string name_in_errors(const std::string& file) const {
    return GetParam().in_memory() ? file : (folder_ / "").string();
  }

  model::TestFolder folder_;
};

uint32_t seed_of(const std::string& name) {
  uint32_t seed = 2166136261;
  for (const char c : name) seed = (seed ^ static_cast<uint8_t>(c)) * 16777619;
  return seed;
}

TEST_P(DamagedScanTest, TheUndamagedScanIsRead) {
  const auto& [name, text] = *GetParam().files.begin();
  const Status status = read(name, text);
  EXPECT_TRUE(status) << status.error().message;
}

TEST_P(DamagedScanTest, DamagedBytesAreReadOrRefusedWithinBounds) {
  const int count = testing::sample_size("SURFCAST_DAMAGED_INPUTS", 250);
  const Scan& scan = GetParam();
  Random random(seed_of(scan.name));
  int refused = 0;
  for (int i = 0; i < count && !HasFailure(); ++i) {
    const auto file = std::next(scan.files.begin(), static_cast<std::ptrdiff_t>(below(random, scan.files.size())));
    std::string text = file->second;
    for (auto times = 1 + random() % 2; times > 0; --times) damage(text, random);
    if (scan.repair) scan.repair(text, random);
    SCOPED_TRACE("input " + std::to_string(i) + ", " + file->first);
    const size_t before = model::bytes_in_use();
    model::start_peak();
    const double start = processor_seconds();
    const Status status = read(file->first, text);
    EXPECT_LT(processor_seconds() - start, 1);
    EXPECT_LT(model::peak_bytes_in_use() - before, kMaxMemory);
    if (!status) expect_one_line_for_people(status.error(), name_in_errors(file->first));
    refused += status ? 0 : 1;
    if (!scan.in_memory()) write(file->first, file->second);
  }
  EXPECT_GT(refused, count / 20);
}

INSTANTIATE_TEST_SUITE_P(AllReaders, DamagedScanTest, ::testing::ValuesIn(all_scans()), [](const auto& scan) {
  std::string name = scan.param.name;
  std::replace_if(
      name.begin(), name.end(), [](unsigned char c) { return std::isalnum(c) == 0; }, '_');
  return name;
});

}  // namespace
}  // namespace surfcast::scan
