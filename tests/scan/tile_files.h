#pragma once

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
