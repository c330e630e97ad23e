#include "scan/implicit_tiles.h"

#include <array>
#include <string_view>
#include <utility>

#include "base/invalid_input.h"
#include "base/json_text.h"
#include "scan/scalar_type.h"
#include "scan/text_tokens.h"

namespace surfcast::scan {
namespace {

using Bytes = std::span<const std::byte>;

/// Bits that number the tiles of a level of a subtree.
constexpr uint32_t kMaxSubtreeBits = 40;
/// Levels whose coordinates have less than 64 bits.
constexpr uint32_t kMaxLevels = 60;

const Json& extension(const Json& json, const char* name) {
  return member(member(json, "extensions"), name);
}

/// Names of tiles must differ, so that a short file cannot stand for any number of tiles.
bool names_every_tile(const std::string& pattern, uint32_t axes) {
  constexpr std::array kVariables{"{level}", "{x}", "{y}", "{z}"};
  for (size_t i = 0; i <= axes; ++i) {
    if (pattern.find(kVariables[i]) == std::string::npos) return false;
  }
  return true;
}

void replace_all(std::string& text, std::string_view variable, uint64_t value) {
  const std::string digits = std::to_string(value);
  for (size_t at = text.find(variable); at != std::string::npos; at = text.find(variable, at + digits.size())) {
    text.replace(at, variable.size(), digits);
  }
}

/// A member by its name in 3D Tiles 1.1, or in the extension of 1.0.
const Json& either(const Json& json, const char* name, const char* former) {
  const Json& found = member(json, name);
  return found.is_null() ? member(json, former) : found;
}

Result<Json> parse_object(Bytes text) {
  Json json = parse_json_text(as_text(text));
  if (!json.is_object()) return invalid_input("a subtree that is no JSON object");
  return json;
}

/// The JSON of a subtree, and the bytes behind it.
struct SubtreeParts {
  Json json;
  Bytes binary;
};

Result<SubtreeParts> split_subtree(Bytes bytes) {
  constexpr size_t kSubtreeHeader = 24;
  Bytes text = bytes;
  Bytes binary;
  if (as_text(bytes).starts_with("subt")) {
    if (bytes.size() < kSubtreeHeader) return invalid_input("truncated: the header of a subtree");
    if (load<uint32_t>(&bytes[4]) != 1) return fail(ErrorKind::kUnsupported, "a subtree of an unknown version");
    const auto json_bytes = load<uint64_t>(&bytes[8]);
    const auto binary_bytes = load<uint64_t>(&bytes[16]);
    const Bytes rest = bytes.subspan(kSubtreeHeader);
    if (json_bytes > rest.size() || binary_bytes > rest.size() - json_bytes) {
      return invalid_input("truncated: a subtree shorter than it states");
    }
    text = rest.first(json_bytes);
    binary = rest.subspan(json_bytes, binary_bytes);
  }
  Result<Json> json = parse_object(text);
  if (!json) return fail(json);
  return SubtreeParts{std::move(*json), binary};
}

}  // namespace

std::vector<Json> contents_of(const Json& tile) {
  const Json& one = member(tile, "content");
  if (one.is_object()) return {one};
  const Json& more = extension(tile, "3DTILES_multiple_contents");
  for (const Json* list : {&member(tile, "contents"), &member(more, "contents"), &member(more, "content")}) {
    if (list->is_array()) return {list->begin(), list->end()};
  }
  return {};
}

std::string content_name(const Json& content) {
  std::string uri = text_of(content, "uri");
  return uri.empty() ? text_of(content, "url") : uri;
}

Result<std::optional<ImplicitTiling>> implicit_tiling_of(const Json& tile) {
  const Json& direct = member(tile, "implicitTiling");
  const Json& stated = direct.is_null() ? extension(tile, "3DTILES_implicit_tiling") : direct;
  if (stated.is_null()) return std::optional<ImplicitTiling>();
  ImplicitTiling tiling;
  const std::string scheme = text_of(stated, "subdivisionScheme");
  if (scheme != "QUADTREE" && scheme != "OCTREE") {
    return fail(ErrorKind::kUnsupported, "implicit tiling of the scheme " + printable(scheme) + " is not supported");
  }
  tiling.axes = scheme == "OCTREE" ? 3 : 2;
  const uint64_t subtree_levels = integer_of(stated, "subtreeLevels").value_or(0);
  const uint64_t levels =
      integer_of(stated, "availableLevels").value_or(integer_of(stated, "maximumLevel").value_or(kMaxLevels) + 1);
  if (subtree_levels == 0 || subtree_levels * tiling.axes > kMaxSubtreeBits || levels == 0 || levels > kMaxLevels) {
    return invalid_input("implicit tiling with levels that cannot be");
  }
  tiling.subtree_levels = static_cast<uint32_t>(subtree_levels);
  tiling.available_levels = static_cast<uint32_t>(levels);
  tiling.subtrees = text_of(member(stated, "subtrees"), "uri");
  for (const Json& content : contents_of(tile)) tiling.names.push_back(content_name(content));
  bool named = names_every_tile(tiling.subtrees, tiling.axes);
  for (const std::string& name : tiling.names) named = named && names_every_tile(name, tiling.axes);
  if (!named) return invalid_input("implicit tiling with a template that lacks level or coordinates");
  return std::optional(std::move(tiling));
}

std::string name_of_tile(const std::string& pattern, const TileKey& key) {
  std::string name = pattern;
  replace_all(name, "{level}", key.level);
  replace_all(name, "{x}", key.x);
  replace_all(name, "{y}", key.y);
  replace_all(name, "{z}", key.z);
  return name;
}

TileKey child_of(const TileKey& parent, uint64_t child) {
  return {parent.level + 1, 2 * parent.x + (child & 1), 2 * parent.y + (child >> 1 & 1),
          2 * parent.z + (child >> 2 & 1)};
}

bool Subtree::Availability::at(uint64_t index) const {
  if (!bits) return constant;
  return (std::to_integer<unsigned>((*bits)[index / 8]) >> (index % 8) & 1U) != 0;
}

Result<Subtree> Subtree::open(const std::filesystem::path& folder, const std::string& name,
                              const ImplicitTiling& tiling) {
  Result<TileFile> file = TileFile::open(folder, name);
  if (!file) return fail(file);
  Subtree subtree(std::move(*file));
  if (Status status = subtree.read(folder, name, tiling); !status) return subtree.file_.error(status.error());
  return subtree;
}

Status Subtree::read(const std::filesystem::path& folder, const std::string& name, const ImplicitTiling& tiling) {
  const Result<SubtreeParts> parts = split_subtree(file_.bytes());
  if (!parts) return fail(parts);
  axes_ = tiling.axes;
  if (Status status = open_buffers(parts->json, folder, name, parts->binary); !status) return status;
  const auto take = [&](const Json& stated, uint64_t count, Availability& to) -> Status {
    Result<Availability> made = availability(parts->json, stated, count);
    if (!made) return fail(made);
    to = *made;
    return {};
  };
  const uint64_t tiles = index_of(tiling.subtree_levels, 0);
  if (Status status = take(member(parts->json, "tileAvailability"), tiles, tiles_); !status) return status;
  const uint64_t below = uint64_t{1} << tiling.axes * tiling.subtree_levels;
  if (Status status = take(member(parts->json, "childSubtreeAvailability"), below, children_); !status) return status;
  const Json& contents = member(parts->json, "contentAvailability");
  const Json& more = member(extension(parts->json, "3DTILES_multiple_contents"), "contentAvailability");
  const Json& stated = contents.is_null() ? more : contents;
  contents_.resize(tiling.names.size());
  for (size_t i = 0; i < contents_.size(); ++i) {
    const Json& one = stated.is_object() && i == 0 ? stated : element(stated, i);
    if (Status status = take(one, tiles, contents_[i]); !status) return status;
  }
  return {};
}

Status Subtree::open_buffers(const Json& json, const std::filesystem::path& folder, const std::string& name,
                             Bytes binary) {
  for (const Json& buffer : member(json, "buffers")) {
    const std::string uri = text_of(buffer, "uri");
    if (uri.empty()) {
      buffers_.push_back(buffers_.empty() ? binary : Bytes());
      continue;
    }
    Result<TileFile> file = TileFile::open(folder, (std::filesystem::path(name).parent_path() / uri).string());
    if (!file) return fail(file);
    buffer_files_.push_back(std::move(*file));
    buffers_.push_back(buffer_files_.back().bytes());
  }
  return {};
}

/// What is not stated is not there.
Result<Subtree::Availability> Subtree::availability(const Json& json, const Json& stated, uint64_t count) const {
  Availability made;
  const std::optional<uint64_t> number = integer_of(either(stated, "bitstream", "bufferView"));
  if (!number) {
    made.constant = integer_of(stated, "constant").value_or(0) == 1;
    return made;
  }
  const Json& view = element(member(json, "bufferViews"), *number);
  const uint64_t buffer = integer_of(view, "buffer").value_or(UINT64_MAX);
  const uint64_t offset = integer_of(view, "byteOffset").value_or(0);
  const uint64_t length = integer_of(view, "byteLength").value_or(0);
  if (buffer >= buffers_.size()) return invalid_input("a bit stream that is not there");
  const Bytes bytes = buffers_[buffer];
  if (offset > bytes.size() || length > bytes.size() - offset || length < (count + 7) / 8) {
    return invalid_input("truncated: a bit stream that is shorter than its subtree");
  }
  made.bits = bytes.subspan(offset, length);
  return made;
}

/// The number of tiles in the levels above, and before it in its own.
uint64_t Subtree::index_of(uint32_t level, uint64_t number) const {
  return ((uint64_t{1} << axes_ * level) - 1) / ((uint64_t{1} << axes_) - 1) + number;
}

bool Subtree::has_tile(uint32_t level, uint64_t number) const {
  return tiles_.at(index_of(level, number));
}

bool Subtree::has_content(size_t content, uint32_t level, uint64_t number) const {
  return contents_[content].at(index_of(level, number));
}

bool Subtree::has_child(uint64_t number) const {
  return children_.at(number);
}

}  // namespace surfcast::scan
