#include "colorize/geo_photo.h"

#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <glm/matrix.hpp>
#include <optional>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "base/mapped_file.h"
#include "mesh/texture.h"
#include "scan/text_tokens.h"

namespace surfcast::colorize {
namespace {

namespace fs = std::filesystem;
using Bytes = std::span<const std::byte>;

tl::unexpected<Error> damaged(const char* what) {
  return fail(ErrorKind::kInvalidInput, what);
}

Status check_frame(const PhotoFrame& frame) {
  const double determinant = glm::determinant(frame.to_world);
  const bool finite = std::isfinite(determinant) && std::isfinite(frame.origin.x) && std::isfinite(frame.origin.y);
  if (finite && determinant != 0) return {};
  return damaged("the place of its pixels makes no sense");
}

/// The first directory of a TIFF file (revision 6.0): entries of a tag, a type, a count, and values or their offset.
class TiffTags {
 public:
  static Result<TiffTags> open(Bytes bytes) {
    const std::string_view text = scan::as_text(bytes);
    const bool little = text.starts_with("II");
    if (bytes.size() < 8 || (!little && !text.starts_with("MM"))) return damaged("is no TIFF file");
    TiffTags tags(bytes, little != (std::endian::native == std::endian::little));
    if (tags.number<uint16_t>(2) != 42) return damaged("is a BigTIFF file: give it a world file");
    tags.directory_ = tags.number<uint32_t>(4).value_or(0);
    return tags;
  }

  /// The values of a tag of doubles; none without it.
  [[nodiscard]] std::vector<double> doubles(uint16_t tag) const { return values<double>(tag, 12); }
  [[nodiscard]] std::vector<uint16_t> shorts(uint16_t tag) const { return values<uint16_t>(tag, 3); }

 private:
  TiffTags(Bytes bytes, bool swapped) : bytes_(bytes), swapped_(swapped) {}

  template <typename T>
  [[nodiscard]] std::optional<T> number(uint64_t offset) const {
    if (offset > bytes_.size() || bytes_.size() - offset < sizeof(T)) return std::nullopt;
    return scan::load<T>(bytes_.data() + offset, swapped_);
  }

  template <typename T>
  [[nodiscard]] std::vector<T> values(uint16_t tag, uint16_t type) const {
    constexpr uint64_t kEntry = 12;
    constexpr uint32_t kMaxValues = 65536;
    std::vector<T> all;
    const uint64_t entries = number<uint16_t>(directory_).value_or(0);
    for (uint64_t i = 0; i < entries; ++i) {
      const uint64_t entry = directory_ + 2 + i * kEntry;
      if (number<uint16_t>(entry) != tag || number<uint16_t>(entry + 2) != type) continue;
      const uint32_t count = number<uint32_t>(entry + 4).value_or(0);
      if (count > kMaxValues) return {};
      const uint64_t first = count * sizeof(T) <= 4 ? entry + 8 : number<uint32_t>(entry + 8).value_or(UINT32_MAX);
      for (uint32_t k = 0; k < count; ++k) {
        const std::optional<T> value = number<T>(first + k * sizeof(T));
        if (!value) return {};
        all.push_back(*value);
      }
      return all;
    }
    return all;
  }

  Bytes bytes_;
  bool swapped_;
  uint64_t directory_ = 0;
};

/// True if coordinates of the raster are centres of pixels, not corners (GTRasterTypeGeoKey = RasterPixelIsPoint).
bool counts_centres(const TiffTags& tags) {
  constexpr uint16_t kKeys = 34735;
  constexpr uint16_t kRasterType = 1025;
  constexpr uint16_t kIsPoint = 2;
  const std::vector<uint16_t> keys = tags.shorts(kKeys);
  for (size_t i = 4; i + 3 < keys.size(); i += 4) {
    if (keys[i] == kRasterType) return keys[i + 1] == 0 && keys[i + 3] == kIsPoint;
  }
  return false;
}

/// Names of world files: photo.tfw, photo.tifw, photo.wld.
std::vector<fs::path> world_files(const fs::path& photo) {
  const std::string extension = photo.extension().string();
  std::vector<std::string> names{".wld"};
  if (extension.size() >= 4) {
    names.push_back(std::string{'.', extension[1], extension.back(), 'w'});
    names.push_back(extension + "w");
  }
  std::vector<fs::path> files;
  files.reserve(names.size());
  for (const std::string& name : names) files.push_back(fs::path(photo).replace_extension(name));
  return files;
}

Result<PhotoFrame> frame_of(const fs::path& path) {
  for (const fs::path& file : world_files(path)) {
    std::error_code ignored;
    if (!fs::is_regular_file(file, ignored)) continue;
    const Result<MappedFile> content = MappedFile::open(file);
    if (!content) return fail(content);
    Result<PhotoFrame> frame = parse_world_file(scan::as_text(content->bytes()));
    if (frame) return frame;
    return fail_about(file.string(), frame);
  }
  const Result<MappedFile> content = MappedFile::open(path);
  if (!content) return fail(content);
  return parse_geotiff(content->bytes()).map_error([&path](const Error& error) {
    return Error{error.kind, path.string() + ": has no world file, and " + error.message};
  });
}

}  // namespace

glm::dvec2 PhotoFrame::pixel_of(const glm::dvec2& world) const {
  return glm::inverse(to_world) * (world - origin);
}

double PhotoFrame::pixel_side() const {
  return std::sqrt(std::abs(glm::determinant(to_world)));
}

Result<PhotoFrame> parse_world_file(std::string_view text) {
  scan::Tokens tokens(text);
  std::array<double, 6> n{};
  for (double& number : n) {
    const std::optional<double> read = scan::parse_number<double>(tokens.next());
    if (!read) return damaged("is not a world file: expected six numbers");
    number = *read;
  }
  PhotoFrame frame{glm::dmat2(n[0], n[1], n[2], n[3]), {}};
  frame.origin = glm::dvec2(n[4], n[5]) - frame.to_world * glm::dvec2(0.5);
  if (Status status = check_frame(frame); !status) return fail(status);
  return frame;
}

Result<PhotoFrame> parse_geotiff(std::span<const std::byte> bytes) {
  const Result<TiffTags> tags = TiffTags::open(bytes);
  if (!tags) return fail(tags);
  const std::vector<double> scale = tags->doubles(33550);
  const std::vector<double> tie = tags->doubles(33922);
  const std::vector<double> matrix = tags->doubles(34264);
  PhotoFrame frame;
  if (matrix.size() == 16) {
    frame.to_world = glm::dmat2(matrix[0], matrix[4], matrix[1], matrix[5]);
    frame.origin = {matrix[3], matrix[7]};
  } else if (scale.size() >= 2 && tie.size() >= 6) {
    frame.to_world = glm::dmat2(scale[0], 0, 0, -scale[1]);
    frame.origin = glm::dvec2(tie[3], tie[4]) - frame.to_world * glm::dvec2(tie[0], tie[1]);
  } else {
    return damaged("its TIFF tags do not state where it lies");
  }
  if (counts_centres(*tags)) frame.origin -= frame.to_world * glm::dvec2(0.5);
  if (Status status = check_frame(frame); !status) return fail(status);
  return frame;
}

Result<GeoPhoto> read_geo_photo(const std::filesystem::path& path, const scan::DecodingLimit& limit) {
  Result<PhotoFrame> frame = frame_of(path);
  if (!frame) return fail(frame);
  Result<mesh::Texture> texture = mesh::read_texture({path.string(), path, {}, {}}, limit);
  if (!texture) return fail_about(path.string(), texture);
  return GeoPhoto{std::move(*texture), *frame};
}

}  // namespace surfcast::colorize
