// brick_bench GRID...: measures ways to code the bricks of grids, on one core. Prints for each way bits per sample of
// the grid, and nanoseconds per stored sample (halos included) to encode and to decode, without reading.

#include <cstdio>
#include <functional>
#include <string>
#include <vector>

#include <zstd.h>

#include "bench_support.h"
#include "grid/grid_reader.h"
#include "model/draco_table.h"
#include "volume/brick_coding.h"
#include "volume/differences.h"
#include "volume/pyramid.h"

namespace surfcast::bench {
namespace {

using Bytes = std::vector<std::byte>;

struct Coding {
  std::string name;
  std::function<Bytes(const volume::Brick&)> encode;
  std::function<volume::Brick(const Bytes&, const volume::BrickHeader&)> decode;
};

/// Draco's columns, which differ from row to row, of the codes or of their differences.
Coding draco_coding(const std::string& name, uint32_t axes) {
  constexpr model::TableType kType{2, 1};
  return {name,
          [=](const volume::Brick& brick) {
            model::TableAttribute table{kType, brick.codes};
            volume::take_differences(table.values, volume::stored_size(brick.header.count), axes);
            return model::encode_table(std::span(&table, 1));
          },
          [=](const Bytes& bytes, const volume::BrickHeader& header) {
            const uint32_t rows = volume::stored_samples(header.count);
            auto tables = value_or_exit(model::decode_table(bytes, std::span(&kType, 1), rows, 1));
            volume::sum_differences(tables[0].values, volume::stored_size(header.count), axes);
            return volume::Brick{header, std::move(tables[0].values)};
          }};
}

/// Differences along that many axes, compressed by zstd at that level as words of 16 bits.
Coding zstd_coding(const std::string& name, uint32_t axes, int level) {
  return {name,
          [=](const volume::Brick& brick) {
            std::vector<uint16_t> codes = brick.codes;
            volume::take_differences(codes, volume::stored_size(brick.header.count), axes);
            Bytes planes(codes.size() * 2);
            for (size_t i = 0; i < codes.size(); ++i) {
              planes[i] = static_cast<std::byte>(codes[i]);
              planes[codes.size() + i] = static_cast<std::byte>(codes[i] >> 8);
            }
            Bytes packed(ZSTD_compressBound(planes.size()));
            packed.resize(ZSTD_compress(packed.data(), packed.size(), planes.data(), planes.size(), level));
            return packed;
          },
          [=](const Bytes& bytes, const volume::BrickHeader& header) {
            const size_t count = volume::stored_samples(header.count);
            Bytes planes(count * 2);
            ZSTD_decompress(planes.data(), planes.size(), bytes.data(), bytes.size());
            volume::Brick brick{header, std::vector<uint16_t>(count)};
            for (size_t i = 0; i < count; ++i) {
              brick.codes[i] = static_cast<uint16_t>(std::to_integer<uint32_t>(planes[i]) |
                                                     std::to_integer<uint32_t>(planes[count + i]) << 8);
            }
            volume::sum_differences(brick.codes, volume::stored_size(header.count), axes);
            return brick;
          }};
}

Coding chosen_coding() {
  return {"smallest of all, zstd 1", volume::encode_brick, [](const Bytes& bytes, const volume::BrickHeader& header) {
            return value_or_exit(volume::decode_brick(bytes, header));
          }};
}

/// The bricks of the finest level.
std::vector<volume::Brick> bricks_of(const char* path) {
  grid::GridReader reader = value_or_exit(grid::GridReader::open(path));
  const grid::GridHeader header = reader.header();
  const glm::u32vec3 size(header.size[0], header.size[1], header.size[2]);
  std::vector<volume::Brick> bricks;
  const volume::SampleScale scale{1, 0, scan::is_floating(header.type) ? 0.0 : 1.0};
  volume::Pyramid<double>* source = nullptr;
  volume::Pyramid<double> pyramid(size, [&](uint32_t level, uint32_t k) -> Status {
    const glm::u32vec3 count = volume::level_bricks(size, level);
    for (uint32_t i = 0; level == 0 && i < count.x * count.y; ++i) {
      volume::BrickHeader place;
      place.brick = {i % count.x, i / count.x, k};
      place.count = volume::brick_count(size, 0, place.brick);
      bricks.push_back(volume::make_brick(place, source->samples(0, place.brick), scale));
    }
    return {};
  });
  source = &pyramid;
  for (uint32_t k = 0; k < size.z; ++k) {
    if (!reader.read(pyramid.next_plane()) || !pyramid.add_plane()) std::exit(1);
  }
  return bricks;
}

void measure(const Coding& coding, const std::vector<volume::Brick>& bricks) {
  size_t samples = 0;
  size_t stored = 0;
  size_t size = 0;
  std::vector<Bytes> coded;
  const double start = processor_ms();
  for (const volume::Brick& brick : bricks) coded.push_back(coding.encode(brick));
  const double encoded = processor_ms();
  bool same = true;
  for (size_t i = 0; i < bricks.size(); ++i) {
    same = coding.decode(coded[i], bricks[i].header).codes == bricks[i].codes && same;
  }
  const double decoded = processor_ms();
  for (size_t i = 0; i < bricks.size(); ++i) {
    const glm::u32vec3 count = bricks[i].header.count;
    samples += size_t{count.x} * count.y * count.z;
    stored += bricks[i].codes.size();
    size += coded[i].size();
  }
  std::printf("%-26s %6.2f bits, encode %5.1f ns, decode %5.1f ns%s\n", coding.name.c_str(),
              8 * static_cast<double>(size) / static_cast<double>(samples),
              1e6 * (encoded - start) / static_cast<double>(stored),
              1e6 * (decoded - encoded) / static_cast<double>(stored), same ? "" : ": WRONG");
}

}  // namespace
}  // namespace surfcast::bench

int main(int argc, char** argv) {
  using namespace surfcast::bench;
  if (argc < 2) {
    std::fprintf(stderr, "usage: brick_bench GRID...\n");
    return 2;
  }
  const std::vector<Coding> codings{draco_coding("Draco", 0),
                                    draco_coding("differences i j k, Draco", 3),
                                    zstd_coding("zstd 1", 0, 1),
                                    zstd_coding("differences i, zstd 1", 1, 1),
                                    zstd_coding("differences i j, zstd 1", 2, 1),
                                    zstd_coding("differences i j k, zstd 1", 3, 1),
                                    zstd_coding("differences i j k, zstd 9", 3, 9),
                                    chosen_coding()};
  for (int i = 1; i < argc; ++i) {
    const auto bricks = bricks_of(argv[i]);
    std::printf("%s: %zu bricks\n", argv[i], bricks.size());
    for (const Coding& coding : codings) measure(coding, bricks);
  }
  return 0;
}
