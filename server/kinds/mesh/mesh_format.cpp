#include "mesh/mesh_format.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <string>
#include <string_view>

#include "base/ascii_text.h"
#include "mesh/ply_mesh.h"
#include "scan/gltf_buffers.h"
#include "scan/gltf_points.h"
#include "scan/text_tokens.h"

namespace surfcast::mesh {
namespace {

/// Bytes that are looked at to tell text formats apart.
constexpr size_t kLook = 65536;

/// Binary STL has no signature, and some files begin like those of text. The size decides: 84 bytes and 50 a triangle.
bool is_binary_stl(std::span<const std::byte> bytes) {
  constexpr size_t kHeader = 84;
  constexpr uint64_t kRecord = 50;
  if (bytes.size() < kHeader) return false;
  uint32_t count = 0;
  std::memcpy(&count, bytes.data() + kHeader - sizeof count, sizeof count);
  return count > 0 && bytes.size() == kHeader + kRecord * count;
}

bool is_text_stl(std::string_view head) {
  scan::Tokens tokens(head);
  return tokens.next() == "solid" && head.find("facet") != std::string_view::npos;
}

/// Like those of scans, lines of OBJ may be nothing but numbers after a word: the words decide. The bytes of a binary
/// scan hold such lines by chance.
bool is_obj(std::string_view head) {
  if (head.find('\0') != std::string_view::npos) return false;
  bool vertex = false;
  bool other = false;
  while (!head.empty()) {
    const size_t end = std::min(head.find_first_of("\r\n"), head.size());
    const std::string_view word = scan::Tokens(head.substr(0, end)).next();
    constexpr std::array<std::string_view, 7> kOther{"vt", "vn", "f", "mtllib", "usemtl", "o", "g"};
    vertex = vertex || word == "v";
    other = other || std::find(kOther.begin(), kOther.end(), word) != kOther.end();
    if (vertex && other) return true;
    head.remove_prefix(std::min(end + 1, head.size()));
  }
  return false;
}

/// glTF of points is a scan.
std::optional<MeshFormat> unless_of_points(std::span<const std::byte> bytes, MeshFormat format) {
  return scan::is_gltf_of_points(bytes) ? std::nullopt : std::optional(format);
}

}  // namespace

std::optional<MeshFormat> mesh_format_of(std::span<const std::byte> bytes, const std::filesystem::path& path,
                                         FacePolicy faces) {
  const std::string_view text = scan::as_text(bytes);
  const std::string_view head = text.substr(0, kLook);
  if (text.starts_with("glTF")) return unless_of_points(bytes, MeshFormat::kGlb);
  if (text.starts_with("ply")) {
    return is_ply_mesh(bytes, faces) ? std::optional(MeshFormat::kPly) : std::nullopt;
  }
  if (is_binary_stl(bytes) || is_text_stl(head)) return MeshFormat::kStl;
  const std::string extension = lower_extension(path);
  if (extension == ".gltf" || scan::is_gltf_text(head)) return unless_of_points(bytes, MeshFormat::kGltf);
  if (extension == ".obj" || is_obj(head)) return MeshFormat::kObj;
  if (extension == ".glb") return MeshFormat::kGlb;
  if (extension == ".stl") return MeshFormat::kStl;
  return std::nullopt;
}

}  // namespace surfcast::mesh
