// make_scan POINTS FILE.las [X,Y,SIDE [forest]]: writes a generated scan as LAS 1.4, point format 7, or of a scan of so
// many points those of a square alone: its corner and side in metres from the corner of the scene. The scene is a town,
// or a forest.
//
// The scene is the same for any number of points, so that scans of different sizes differ only in density. Points are
// streamed, so that a scan may be larger than memory.

#include <array>
#include <charconv>
#include <cmath>
#include <cstring>
#include <iostream>
#include <optional>
#include <string_view>
#include <vector>

#include <oneapi/tbb/parallel_for.h>

#include "base/atomic_file.h"
#include "scan_scene.h"

namespace {

using surfcast::AtomicFile;
using surfcast::Status;

constexpr size_t kHeaderBytes = 375;
constexpr size_t kRecordBytes = 36;
constexpr uint64_t kBatch = uint64_t{1} << 20;
constexpr double kScale = 0.001;
constexpr double kEasting = 552000;
constexpr double kNorthing = 5801000;

template <typename T>
void put(std::byte* record, size_t offset, T value) {
  std::memcpy(record + offset, &value, sizeof(T));
}

int32_t steps(double metres) {
  return static_cast<int32_t>(std::lround(metres / kScale));
}

/// Writes a point record (LAS 1.4, table 20).
void put_echo(std::byte* record, const surfcast::bench::Echo& echo, uint64_t index) {
  put(record, 0, steps(echo.position.x));
  put(record, 4, steps(echo.position.y));
  put(record, 8, steps(echo.position.z));
  put(record, 12, echo.intensity);
  put(record, 14, static_cast<uint8_t>(echo.return_number | echo.returns << 4));
  put(record, 15, uint8_t{0});
  put(record, 16, echo.classification);
  put(record, 17, uint8_t{0});
  put(record, 18, int16_t{0});
  put(record, 20, uint16_t{1});
  put(record, 22, 3e8 + static_cast<double>(index) * 0x1p-19);
  for (int channel = 0; channel < 3; ++channel) put(record, 30 + 2 * static_cast<size_t>(channel), echo.color[channel]);
}

/// The file header (LAS 1.4, table 3).
std::vector<std::byte> make_header(uint64_t count) {
  std::vector<std::byte> header(kHeaderBytes);
  std::byte* at = header.data();
  std::memcpy(at, "LASF", 4);
  put(at, 24, uint8_t{1});
  put(at, 25, uint8_t{4});
  std::memcpy(at + 58, "make_scan", 9);
  put(at, 94, static_cast<uint16_t>(kHeaderBytes));
  put(at, 96, static_cast<uint32_t>(kHeaderBytes));
  put(at, 104, uint8_t{7});
  put(at, 105, static_cast<uint16_t>(kRecordBytes));
  const double offset[3] = {kEasting, kNorthing, 0};
  const double top[3] = {surfcast::bench::kSceneSide, surfcast::bench::kSceneSide, 300};
  for (size_t axis = 0; axis < 3; ++axis) {
    put(at, 131 + 8 * axis, kScale);
    put(at, 155 + 8 * axis, offset[axis]);
    put(at, 179 + 16 * axis, offset[axis] + top[axis]);
    put(at, 187 + 16 * axis, offset[axis]);
  }
  put(at, 247, count);
  return header;
}

Status write_scan(const surfcast::bench::ScanPart& part, surfcast::bench::Landscape landscape, const char* path) {
  surfcast::Result<AtomicFile> file = AtomicFile::create(path);
  if (!file) return surfcast::fail(file);
  if (Status status = file->append(make_header(part.size())); !status) return status;
  std::vector<std::byte> batch;
  for (uint64_t first = 0; first < part.size(); first += kBatch) {
    const uint64_t points = std::min(kBatch, part.size() - first);
    batch.assign(points * kRecordBytes, std::byte{0});
    oneapi::tbb::parallel_for(uint64_t{0}, points, [&](uint64_t i) {
      const uint64_t index = part.index(first + i);
      put_echo(batch.data() + i * kRecordBytes, surfcast::bench::scan_echo(index, part.count, landscape), index);
    });
    if (Status status = file->append(batch); !status) return status;
  }
  return file->commit();
}

/// The numbers of "X,Y,SIDE"; none if it has another form.
std::optional<std::array<double, 3>> read_square(std::string_view text) {
  std::array<double, 3> numbers{};
  const char* at = text.data();
  const char* const end = at + text.size();
  for (size_t i = 0; i < numbers.size(); ++i) {
    if (i > 0 && (at == end || *at++ != ',')) return std::nullopt;
    const auto [next, code] = std::from_chars(at, end, numbers.at(i));
    if (code != std::errc()) return std::nullopt;
    at = next;
  }
  if (at != end || !(numbers[2] > 0)) return std::nullopt;
  return numbers;
}

}  // namespace

int main(int argc, char** argv) {
  uint64_t count = 0;
  const std::string_view wanted = argc >= 3 && argc <= 5 ? argv[1] : "";
  const auto [end, code] = std::from_chars(wanted.data(), wanted.data() + wanted.size(), count);
  const auto square = read_square(argc >= 4 ? argv[3] : "0,0,1000");
  const bool forest = argc == 5 && std::string_view(argv[4]) == "forest";
  if (code != std::errc() || end != wanted.data() + wanted.size() || count == 0 || !square || (argc == 5 && !forest)) {
    std::cerr << "usage: make_scan POINTS FILE.las [X,Y,SIDE [forest]]\n";
    return 2;
  }
  const surfcast::bench::ScanPart part = surfcast::bench::part_of_scan(count, (*square)[0], (*square)[1], (*square)[2]);
  using surfcast::bench::Landscape;
  const Status status = write_scan(part, forest ? Landscape::kForest : Landscape::kTown, argv[2]);
  if (!status) std::cerr << "make_scan: " << status.error().message << '\n';
  return status ? 0 : 1;
}
