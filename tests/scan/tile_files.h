#pragma once

#include <algorithm>
#include <cstdint>
#include <initializer_list>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "scan/bytes.h"

namespace surfcast::testing {

/// With spaces to a multiple of eight bytes.
inline std::string padded(std::string text) {
  while (text.size() % 8 != 0) text += ' ';
  return text;
}

/// A point tile of both tables.
inline std::string pnts(std::string features, const std::string& bytes, std::string batches = {},
                        const std::string& batch_bytes = {}) {
  features = padded(std::move(features));
  batches = batches.empty() ? batches : padded(std::move(batches));
  const auto size = [](const std::string& text) { return static_cast<uint32_t>(text.size()); };
  Bytes file("pnts");
  file.add(uint32_t{1}).add(28 + size(features) + size(bytes) + size(batches) + size(batch_bytes));
  file.add(size(features)).add(size(bytes)).add(size(batches)).add(size(batch_bytes));
  return file.add_text(features + bytes + batches + batch_bytes).text();
}

inline std::string one_point(float x) {
  return pnts(R"({"POINTS_LENGTH": 1, "POSITION": {"byteOffset": 0}})", Bytes().add(x).add(0.0F).add(0.0F).text());
}

/// A glTF file, accessor by accessor. Its only mesh has one primitive, of points, at node 0.
struct GltfFile {
  using Json = nlohmann::json;

  Json json = {{"asset", {{"version", "2.0"}}},
               {"scene", 0},
               {"scenes", {{{"nodes", {0}}}}},
               {"nodes", {{{"mesh", 0}}}},
               {"meshes", {{{"primitives", {{{"mode", 0}, {"attributes", Json::object()}}}}}}}};
  std::string bytes;

  Json& primitive() { return json["meshes"][0]["primitives"][0]; }

  size_t add_view(const std::string& content) {
    json["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", bytes.size()}, {"byteLength", content.size()}});
    bytes += content;
    bytes.resize((bytes.size() + 3) / 4 * 4);
    return json["bufferViews"].size() - 1;
  }

  /// A view of compressed elements. An empty filter is left out.
  size_t add_packed_view(const std::string& packed, const std::string& mode, size_t count, size_t stride,
                         const std::string& filter = {}) {
    const size_t view = add_view(packed);
    Json& stated = json["bufferViews"][view];
    Json extension = stated;
    extension.update({{"mode", mode}, {"count", count}, {"byteStride", stride}});
    if (!filter.empty()) extension["filter"] = filter;
    stated = {{"buffer", 1}, {"byteLength", count * stride}, {"extensions", {{"EXT_meshopt_compression", extension}}}};
    if (mode == "ATTRIBUTES") stated["byteStride"] = stride;
    json["extensionsRequired"] = {"EXT_meshopt_compression"};
    return view;
  }

  /// `type`: of a component, as glTF numbers them; `shape`: SCALAR, VEC3 and so on.
  template <typename T>
  GltfFile& add(const std::string& attribute, int type, const std::string& shape, size_t count,
                std::initializer_list<T> values, bool normalized = false) {
    std::string content;
    for (const T value : values) content.append(reinterpret_cast<const char*>(&value), sizeof value);
    Json accessor = {{"bufferView", add_view(content)}, {"componentType", type}, {"count", count}, {"type", shape}};
    if (normalized) accessor["normalized"] = true;
    json["accessors"].push_back(accessor);
    primitive()["attributes"][attribute] = json["accessors"].size() - 1;
    return *this;
  }
  GltfFile& positions(std::initializer_list<float> values) {
    return add<float>("POSITION", 5126, "VEC3", values.size() / 3, values);
  }

  /// As text that names a file with its buffer.
  [[nodiscard]] std::string text(const std::string& buffer) const {
    Json whole = json;
    whole["buffers"] = {{{"byteLength", bytes.size()}, {"uri", buffer}}};
    return whole.dump();
  }
  [[nodiscard]] std::string binary() const {
    Json whole = json;
    whole["buffers"] = {{{"byteLength", bytes.size()}}};
    const std::string text = padded(whole.dump());
    const auto size = [](const std::string& part) { return static_cast<uint32_t>(part.size()); };
    Bytes file("glTF");
    file.add(uint32_t{2}).add(28 + size(text) + size(bytes)).add(size(text)).add_text("JSON").add_text(text);
    return file.add(size(bytes)).add_text(std::string("BIN\0", 4)).add_text(bytes).text();
  }
};

/// Elements of `stride` bytes as an attribute stream of EXT_meshopt_compression. Groups take turns at the ways in which
/// they may be coded.
inline std::string meshopt_attributes(const std::string& plain, size_t stride) {
  const size_t count = plain.size() / stride;
  const size_t block = std::min<size_t>(8192 / stride & ~size_t{15}, 256);
  const auto difference = [&](size_t i, size_t k) -> uint8_t {
    if (i >= count) return 0;
    const int before = i == 0 ? 0 : plain[(i - 1) * stride + k];
    const auto step = static_cast<int8_t>(plain[i * stride + k] - before);
    return static_cast<uint8_t>(step < 0 ? -2 * step - 1 : 2 * step);
  };
  std::string packed = "\xA0";
  for (size_t first = 0; first < count; first += block) {
    const size_t groups = (std::min(block, count - first) + 15) / 16;
    for (size_t k = 0; k < stride; ++k) {
      std::string ways((groups + 3) / 4, '\0');
      std::string data;
      for (size_t group = 0; group < groups; ++group) {
        std::string codes;
        for (size_t i = 0; i < 16; ++i) codes += static_cast<char>(difference(first + group * 16 + i, k));
        const bool still = codes == std::string(16, '\0');
        const size_t way = still ? 0 : 1 + group % 3;
        ways[group / 4] = static_cast<char>(ways[group / 4] | way << group % 4 * 2);
        if (way == 3) data += codes;
        if (way == 0 || way == 3) continue;
        const unsigned most = way == 1 ? 3 : 15;
        const size_t each = way == 1 ? 4 : 2;  // codes in a byte
        std::string whole;
        for (size_t i = 0; i < 16; i += each) {
          unsigned byte = 0;
          for (size_t j = i; j < i + each; ++j) {
            const auto code = static_cast<uint8_t>(codes[j]);
            byte = byte << (8 / each) | std::min<unsigned>(code, most);
            if (code >= most) whole += codes[j];
          }
          data += static_cast<char>(byte);
        }
        data += whole;
      }
      packed += ways + data;
    }
  }
  return packed + std::string(std::max<size_t>(stride, 32), '\0');
}

inline constexpr size_t kPackedPoints = 300;  // more than a block

/// Quantised points, normals and indices of EXT_meshopt_compression.
inline GltfFile meshopt_points() {
  Bytes positions, normals, indices("\xD1");
  for (size_t i = 0; i < kPackedPoints; ++i) {
    positions.add(static_cast<uint16_t>(i * 217))
        .add(static_cast<uint16_t>(i % 7))
        .add(static_cast<uint16_t>(65535 - i));
    positions.add(uint16_t{0});
    // Octahedral, of 8 bits: along z, along -x, and below.
    const int8_t x[] = {0, -127, 127};
    const int8_t y[] = {0, 0, 127};
    normals.add(x[i % 3]).add(y[i % 3]).add(int8_t{127}).add(int8_t{0});
    // The first baseline counts up from 0: a step of 0, then of 1.
    indices.add(static_cast<uint8_t>(i == 0 ? 0 : 1 << 2));
  }
  indices.add(uint32_t{0});
  GltfFile file;
  const size_t position = file.add_packed_view(meshopt_attributes(positions.text(), 8), "ATTRIBUTES", kPackedPoints, 8);
  const size_t normal =
      file.add_packed_view(meshopt_attributes(normals.text(), 4), "ATTRIBUTES", kPackedPoints, 4, "OCTAHEDRAL");
  const size_t index = file.add_packed_view(indices.text(), "INDICES", kPackedPoints, 2);
  const auto accessor = [](size_t view, int type, const char* shape, bool normalized) {
    return nlohmann::json{{"bufferView", view},
                          {"componentType", type},
                          {"count", kPackedPoints},
                          {"type", shape},
                          {"normalized", normalized}};
  };
  file.json["accessors"] = {accessor(position, 5123, "VEC3", false), accessor(normal, 5120, "VEC3", true),
                            accessor(index, 5123, "SCALAR", false)};
  file.primitive()["attributes"] = {{"POSITION", 0}, {"NORMAL", 1}};
  file.primitive()["indices"] = 2;
  return file;
}

/// The bits of numbers below `count`.
inline std::string bits_of(std::initializer_list<size_t> numbers, size_t count) {
  std::string bits((count + 7) / 8, '\0');
  for (const size_t number : numbers) bits[number / 8] = static_cast<char>(bits[number / 8] | 1 << number % 8);
  return bits;
}

/// A binary subtree. `json` names views of the buffer that `binary` is.
inline std::string subtree(const std::string& json, const std::string& binary) {
  const std::string text = padded(json);
  return Bytes("subt").add(uint32_t{1}).add(uint64_t{text.size()}).add(uint64_t{binary.size()}).text() + text + binary;
}

/// A tileset of one implicit tiling.
inline nlohmann::json implicit_tileset(const std::string& scheme, int subtree_levels, int levels) {
  const std::string key = scheme == "OCTREE" ? "{level}/{x}/{y}/{z}" : "{level}/{x}/{y}";
  return {{"asset", {{"version", "1.1"}}},
          {"root",
           {{"refine", "ADD"},
            {"content", {{"uri", "content/" + key + ".pnts"}}},
            {"implicitTiling",
             {{"subdivisionScheme", scheme},
              {"subtreeLevels", subtree_levels},
              {"availableLevels", levels},
              {"subtrees", {{"uri", "subtrees/" + key + ".subtree"}}}}}}}};
}

inline constexpr const char* kBitStreams = R"({"buffers": [{"byteLength": 12}], "bufferViews": [
  {"buffer": 0, "byteLength": 1}, {"buffer": 0, "byteOffset": 4, "byteLength": 1},
  {"buffer": 0, "byteOffset": 8, "byteLength": 2}], "tileAvailability": {"bitstream": 0},
  "contentAvailability": [{"bitstream": 1}], "childSubtreeAvailability": {"bitstream": 2}})";

/// A quadtree of three levels in subtrees of two: root, tiles (0, 1) and (1, 1), and (3, 3) below the latter.
inline std::map<std::string, std::string> quadtree_files(const std::string& refine) {
  std::map<std::string, std::string> files;
  nlohmann::json tileset = implicit_tileset("QUADTREE", 2, 3);
  tileset["root"]["refine"] = refine;
  tileset["root"]["transform"] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 100, 1};
  files["tileset.json"] = (tileset.dump());
  const auto spaced = [](const std::string& bits) { return bits + std::string(4 - bits.size(), '\0'); };
  files["subtrees/0/0/0.subtree"] =
      (subtree(kBitStreams, spaced(bits_of({0, 3, 4}, 5)) + spaced(bits_of({0, 3, 4}, 5)) + spaced(bits_of({15}, 16))));
  files["subtrees/2/3/3.subtree"] = (R"({"tileAvailability": {"bitstream": 0}, "contentAvailability": [{"constant": 1}],
      "childSubtreeAvailability": {"constant": 0}, "bufferViews": [{"buffer": 0, "byteOffset": 1, "byteLength": 1}],
      "buffers": [{"uri": "bits.bin", "byteLength": 2}]})");
  files["subtrees/2/3/bits.bin"] = ("\x01\x01");
  files["content/0/0/0.pnts"] = (one_point(0));
  files["content/1/0/1.pnts"] = (one_point(1));
  files["content/1/1/1.pnts"] = (one_point(2));
  files["content/2/3/3.pnts"] = (one_point(3));
  return files;
}

}  // namespace surfcast::testing
