#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include <brotli/encode.h>
#include <zstd.h>

#include "scan/bytes.h"

namespace surfcast::testing {

inline std::string ept_json(const std::string& type) {
  return R"({"bounds": [0, 0, 0, 8, 8, 8], "dataType": ")" + type + R"(", "hierarchyType": "json", "points": 3,
    "schema": [{"name": "X", "type": "signed", "size": 4, "scale": 0.5, "offset": 1},
               {"name": "Y", "type": "signed", "size": 4, "scale": 0.5},
               {"name": "Z", "type": "float", "size": 8},
               {"name": "Intensity", "type": "unsigned", "size": 2}],
    "srs": {"authority": "EPSG", "horizontal": "2154"}})";
}

inline std::string ept_point(int32_t x, int32_t y, double z, uint16_t intensity) {
  return Bytes().add(x).add(y).add(z).add(intensity).text();
}

inline std::string zstd_of(const std::string& text) {
  std::string packed(ZSTD_compressBound(text.size()), '\0');
  packed.resize(ZSTD_compress(packed.data(), packed.size(), text.data(), text.size(), 3));
  return packed;
}

/// Three nodes, one of them in a page of its own.
template <typename Pack>
void write_ept(const std::function<void(const std::string&, const std::string&)>& write, const std::string& type,
               const std::string& extension, const Pack& pack) {
  write("ept.json", ept_json(type));
  write("ept-hierarchy/0-0-0-0.json", R"({"0-0-0-0": 1, "1-1-0-0": 1, "1-0-1-1": -1})");
  write("ept-hierarchy/1-0-1-1.json", R"({"1-0-1-1": 1})");
  write("ept-data/0-0-0-0" + extension, pack(ept_point(2, 4, 0.25, 7)));
  write("ept-data/1-1-0-0" + extension, pack(ept_point(12, 2, 3, 8)));
  write("ept-data/1-0-1-1" + extension, pack(ept_point(0, 14, 7, 9)));
}

inline std::string cloud_js(const std::string& hierarchy) {
  return R"({"version": "1.7", "octreeDir": "data", "boundingBox": {"lx": 10, "ly": 0, "lz": 0, "ux": 18, "uy": 8,
    "uz": 8}, "pointAttributes": ["POSITION_CARTESIAN", "COLOR_PACKED", "NORMAL_OCT16"], "scale": 0.25, )" +
         hierarchy + "}";
}

inline std::string bin_point(uint32_t x, uint32_t y, uint32_t z) {
  return Bytes().add(x).add(y).add(z).add(uint32_t{0x00030201}).add(uint8_t{255}).add(uint8_t{128}).text();
}

inline std::string hrc_entry(uint8_t mask, uint32_t points) {
  return Bytes().add(mask).add(points).text();
}

inline std::string metadata(const std::string& encoding) {
  return R"({"version": "2.0", "hierarchy": {"firstChunkSize": 44, "stepSize": 4}, "scale": [0.5, 0.5, 0.5],
    "offset": [10, 20, 30], "boundingBox": {"min": [10, 20, 30], "max": [18, 28, 38]}, "encoding": ")" +
         encoding +
         R"(", "attributes": [
      {"name": "position", "size": 12, "numElements": 3, "elementSize": 4, "type": "int32"},
      {"name": "intensity", "size": 2, "numElements": 1, "elementSize": 2, "type": "uint16"},
      {"name": "rgb", "size": 6, "numElements": 3, "elementSize": 2, "type": "uint16"}]})";
}

inline std::string node2(uint8_t type, uint8_t mask, uint32_t points, uint64_t offset, uint64_t bytes) {
  return Bytes().add(type).add(mask).add(points).add(offset).add(bytes).text();
}

inline std::string point2(int32_t x, uint16_t intensity, uint16_t red) {
  return Bytes()
      .add(x)
      .add(int32_t{2})
      .add(int32_t{-3})
      .add(intensity)
      .add(red)
      .add(uint16_t{300})
      .add(uint16_t{5})
      .text();
}

/// 16 bits of each axis, mixed.
inline uint64_t mixed(uint64_t x, uint64_t y, uint64_t z) {
  uint64_t word = 0;
  for (int bit = 0; bit < 16; ++bit) {
    word |= (x >> bit & 1) << 3 * bit | (y >> bit & 1) << (3 * bit + 1) | (z >> bit & 1) << (3 * bit + 2);
  }
  return word;
}

inline std::string brotli_of(const std::string& text) {
  std::string packed(text.size() + 1000, '\0');
  size_t size = packed.size();
  BrotliEncoderCompress(5, BROTLI_DEFAULT_WINDOW, BROTLI_MODE_GENERIC, text.size(),
                        reinterpret_cast<const uint8_t*>(text.data()), &size,
                        reinterpret_cast<uint8_t*>(packed.data()));
  packed.resize(size);
  return packed;
}

/// The node of point2(x, intensity, red), as columns.
inline std::string brotli_node(int32_t x, uint16_t intensity, uint16_t red) {
  const auto bits = static_cast<uint32_t>(x);
  const auto minus = static_cast<uint32_t>(-3);
  return brotli_of(Bytes()
                       .add(mixed(bits >> 16, 0, minus >> 16))
                       .add(mixed(bits & 65535, 2, minus & 65535))
                       .add(intensity)
                       .add(mixed(red, 300, 5))
                       .text());
}

/// A tileset that moves by 10 along x, whose root has content and two children, one by another tileset.
inline constexpr const char* kTileset = R"({"asset": {"version": "1.0"}, "root": {"refine": "REFINE",
  "transform": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 10, 0, 0, 1], "content": {"uri": "root.pnts"}, "children": [
  {"content": {"uri": "a.pnts"}, "transform": [2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 0, 5, 0, 1]},
  {"content": {"url": "sub/more.json"}}]}})";

inline std::string tileset(const std::string& refine) {
  std::string text = kTileset;
  return text.replace(text.find("REFINE"), 6, refine);
}

}  // namespace surfcast::testing
