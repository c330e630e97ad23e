#include "scan/scan_format.h"

#include <algorithm>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "base/ascii_text.h"
#include "scan/gltf_buffers.h"
#include "scan/readers.h"
#include "scan/text_tokens.h"

namespace surfcast::scan {
namespace {

using Known = std::pair<std::string_view, std::string_view>;

/// Signatures of files that cannot be read as scans, with the reason.
constexpr Known kOtherContents[] = {
    {"\x1F\x8B", "gzip-compressed files (SPZ among them) are not supported"},
    {"NGSP", "SPZ files of 3D Gaussians are not supported"},
    {"PK\x03\x04", "zip archives are not supported"},
    {"NRRD", "volumes (NRRD) are not supported"},
    {"# vtk DataFile", "volumes (VTK) are not supported"},
    {"<", "XML and HTML files are not supported"},
    {"{", "JSON files are not supported"},
    {"\x89PNG", "pictures are not scans"},
    {"\xFF\xD8\xFF", "pictures are not scans"},
    {"RIFF", "pictures are not scans"},
    {"OFF", "OFF meshes are not supported"},
    {"solid ", "STL meshes are not supported"},
};

constexpr Known kOtherExtensions[] = {
    {".obj", "OBJ meshes are not supported"},
    {".stl", "STL meshes are not supported"},
    {".mtl", "OBJ materials are not scans"},
    {".off", "OFF meshes are not supported"},
    {".splat", "files of 3D Gaussians (.splat) are not supported"},
    {".surf", "the file is a model already, not a scan"},
    {".raw", "raw volumes are not supported"},
    {".mhd", "volumes (MetaImage) are not supported"},
    {".nhdr", "volumes (NRRD) are not supported"},
};

constexpr std::pair<std::string_view, ScanFormat> kExtensions[] = {
    {".ply", ScanFormat::kPly},   {".las", ScanFormat::kLas},  {".laz", ScanFormat::kLas},
    {".pcd", ScanFormat::kPcd},   {".ptx", ScanFormat::kPtx},  {".drc", ScanFormat::kDraco},
    {".xyz", ScanFormat::kText},  {".pts", ScanFormat::kText}, {".txt", ScanFormat::kText},
    {".csv", ScanFormat::kText},  {".asc", ScanFormat::kText}, {".e57", ScanFormat::kE57},
    {".pnts", ScanFormat::kPnts},
};

std::string_view format_name(ScanFormat format) {
  switch (format) {
    case ScanFormat::kPly:
      return "PLY";
    case ScanFormat::kLas:
      return "LAS";
    case ScanFormat::kPcd:
      return "PCD";
    case ScanFormat::kPtx:
      return "PTX";
    case ScanFormat::kAsciiGrid:
      return "ESRI ASCII grid";
    case ScanFormat::kDraco:
      return "Draco";
    case ScanFormat::kE57:
      return "E57";
    case ScanFormat::kExpe:
      return "Expe";
    case ScanFormat::kPnts:
      return "3D Tiles";
    case ScanFormat::kGltf:
      return "glTF";
    case ScanFormat::kText:
      break;
  }
  return "text";
}

/// True if the text starts with the word, followed by white space.
bool starts_with_word(std::string_view text, std::string_view word) {
  return text.starts_with(word) && text.size() > word.size() && is_space(text[word.size()]);
}

/// Bytes examined to detect the kind of text.
constexpr size_t kLook = 4096;

/// True if there are no control characters other than white space.
bool is_text(std::string_view text) {
  const std::string_view head = text.substr(0, kLook);
  return std::all_of(head.begin(), head.end(),
                     [](char c) { return static_cast<unsigned char>(c) >= ' ' || is_space(c); });
}

/// PCD files may begin with comments; FIELDS is among the first lines.
bool is_pcd(std::string_view text) {
  return text.starts_with("# .PCD") || starts_with_word(text, "VERSION") || starts_with_word(text, "FIELDS");
}

std::optional<ScanFormat> by_content(std::string_view text) {
  if (starts_with_word(text, "ply")) return ScanFormat::kPly;
  if (text.starts_with("LASF")) return ScanFormat::kLas;
  if (text.starts_with("DRACO")) return ScanFormat::kDraco;
  if (text.starts_with("ASTM-E57")) return ScanFormat::kE57;
  if (text.starts_with("[Expe/PointSet")) return ScanFormat::kExpe;
  if (text.starts_with("pnts")) return ScanFormat::kPnts;
  if (text.starts_with("glTF") || is_gltf_text(text)) return ScanFormat::kGltf;
  if (is_pcd(text)) return ScanFormat::kPcd;
  if (looks_like_ascii_grid(text)) return ScanFormat::kAsciiGrid;
  return std::nullopt;
}

tl::unexpected<Error> unsupported(std::string_view what) {
  return fail(ErrorKind::kUnsupported, std::string(what));
}

/// The format of text without a signature. A file with the extension of PLY, PCD and so on that lacks the header is
/// damaged, even if it contains numbers.
Result<ScanFormat> format_of_text(std::string_view text, std::optional<ScanFormat> named) {
  const bool may_be_text = !named || *named == ScanFormat::kText || *named == ScanFormat::kPtx;
  if (!may_be_text) {
    return fail(ErrorKind::kInvalidInput, std::string(format_name(*named)) + " header missing");
  }
  if (looks_like_ptx(text)) return ScanFormat::kPtx;
  if (named || begins_like_text_table(text.substr(0, kLook))) return named.value_or(ScanFormat::kText);
  return unsupported("not a scan of a supported format");
}

}  // namespace

Result<ScanFormat> scan_format_of(std::span<const std::byte> bytes, const std::filesystem::path& path) {
  if (bytes.empty()) return fail(ErrorKind::kInvalidInput, "the file is empty");
  const std::string_view text = as_text(bytes);
  if (const auto format = by_content(text)) return *format;
  for (const auto& [start, what] : kOtherContents) {
    if (text.starts_with(start)) return unsupported(what);
  }
  const std::string extension = lower_extension(path);
  for (const auto& [known, what] : kOtherExtensions) {
    if (extension == known) return unsupported(what);
  }
  const auto* named = std::find_if(std::begin(kExtensions), std::end(kExtensions),
                                   [&extension](const auto& entry) { return entry.first == extension; });
  const bool has_name = named != std::end(kExtensions);
  if (is_text(text)) return format_of_text(text, has_name ? std::optional(named->second) : std::nullopt);
  if (!has_name) return unsupported("not a scan of a supported format");
  return fail(ErrorKind::kInvalidInput, "not a " + std::string(format_name(named->second)) + " file");
}

std::vector<std::string> scan_extensions() {
  std::vector<std::string> all;
  for (const auto& [extension, format] : kExtensions) all.emplace_back(extension);
  return all;
}

}  // namespace surfcast::scan
