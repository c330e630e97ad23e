#include <cmath>
#include <cstring>
#include <string>
#include <utility>

#include "geometry/finite.h"
#include "mesh/readers.h"
#include "scan/text_tokens.h"

namespace surfcast::mesh {
namespace {

constexpr size_t kHeader = 84;
constexpr size_t kRecord = 50;  ///< normal, three corners (floats) and a word of attributes

/// A triangle soup: every triangle has its own positions.
struct Soup {
  std::shared_ptr<Vertices> vertices = std::make_shared<Vertices>();
  std::shared_ptr<std::vector<Triangle>> triangles = std::make_shared<std::vector<Triangle>>();

  void add(const std::array<glm::dvec3, 3>& corners) {
    Triangle triangle;
    for (size_t k = 0; k < 3; ++k) {
      triangle[k].position = static_cast<uint32_t>(vertices->positions.size());
      vertices->positions.push_back(corners[k]);
    }
    triangles->push_back(triangle);
  }
};

Result<Soup> read_binary(std::span<const std::byte> bytes) {
  Soup soup;
  for (size_t at = kHeader; at + kRecord <= bytes.size(); at += kRecord) {
    std::array<float, 12> numbers{};
    std::memcpy(numbers.data(), bytes.data() + at, sizeof numbers);
    std::array<glm::dvec3, 3> corners{};
    for (size_t k = 0; k < 3; ++k) corners[k] = {numbers[3 * k + 3], numbers[3 * k + 4], numbers[3 * k + 5]};
    if (!geometry::finite(corners[0]) || !geometry::finite(corners[1]) || !geometry::finite(corners[2])) {
      return fail(ErrorKind::kInvalidInput, "STL triangle with a corner that is not finite");
    }
    soup.add(corners);
  }
  return soup;
}

/// Words of the text are "facet normal x y z outer loop vertex x y z ... endloop endfacet"; only vertices count.
Result<Soup> read_text(std::string_view text) {
  Soup soup;
  scan::Tokens tokens(text);
  std::array<glm::dvec3, 3> corners{};
  size_t filled = 0;
  for (std::string_view word = tokens.next(); !word.empty(); word = tokens.next()) {
    if (word == "facet") filled = 0;
    if (word != "vertex") continue;
    if (filled == 3) return fail(ErrorKind::kInvalidInput, "STL facet of more than three vertices");
    for (int axis = 0; axis < 3; ++axis) {
      const std::optional<double> number = scan::parse_number<double>(tokens.next());
      if (!number || !std::isfinite(*number)) return fail(ErrorKind::kInvalidInput, "STL vertex without three numbers");
      corners[filled][axis] = *number;
    }
    if (++filled == 3) soup.add(corners);
  }
  if (filled % 3 != 0) return fail(ErrorKind::kInvalidInput, "truncated: STL facet of less than three vertices");
  return soup;
}

bool is_binary(std::span<const std::byte> bytes) {
  uint32_t count = 0;
  if (bytes.size() < kHeader) return false;
  std::memcpy(&count, bytes.data() + kHeader - sizeof count, sizeof count);
  return bytes.size() == kHeader + uint64_t{kRecord} * count;
}

}  // namespace

Result<Mesh> read_stl(const ModelFile& file, const scan::DecodingLimit& limit) {
  const std::span<const std::byte> bytes = file.bytes();
  const bool binary = is_binary(bytes);
  if (!binary && !scan::as_text(bytes).starts_with("solid")) {
    return fail(ErrorKind::kInvalidInput, "truncated: not as many STL triangles as the file states");
  }
  // Positions and indices of a triangle take 108 bytes, arrays grow by doubling; a facet of text has over 60 bytes.
  if (Status status = limit.check(bytes.size() * 5); !status) return fail(status);
  Result<Soup> soup = binary ? read_binary(bytes) : read_text(scan::as_text(bytes));
  if (!soup) return fail(soup);
  Mesh mesh;
  mesh.z_up = true;  // STL comes from mechanical design
  mesh.materials.emplace_back();
  mesh.patches.push_back({std::move(soup->vertices), std::move(soup->triangles), 0, glm::dmat4(1)});
  return mesh;
}

}  // namespace surfcast::mesh
