#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <string_view>
#include <utility>
#include <vector>

#include "grid/readers.h"
#include "scan/text_tokens.h"
#include "stream/inflate_stream.h"

namespace surfcast::grid {
namespace {

using stream::FilePtr;
using stream::StreamPtr;

constexpr size_t kHeader1 = 348;
constexpr size_t kHeader2 = 540;
constexpr int kSymmetricMatrixIntent = 1005;

/// The fields that are used, of either version (nifti1.h, nifti2.h).
struct Fields {
  bool swapped = false;
  bool pair = false;
  int type = 0;
  std::array<int64_t, 8> sizes{};
  std::array<double, 8> spacing{};
  int64_t data_offset = 0;
  double slope = 0;
  double intercept = 0;
  int qform = 0;
  int sform = 0;
  std::array<double, 6> quaternion{};  ///< b c d, then the offset
  std::array<double, 12> rows{};
  int units = 0;
  int intent = 0;
  std::string description;
};

/// Reads fields of a header at their offsets.
class Record {
 public:
  Record(std::span<const std::byte> bytes, bool swapped) : bytes_(bytes), swapped_(swapped) {}
  template <typename T>
  [[nodiscard]] T at(size_t offset) const {
    return scan::load<T>(bytes_.data() + offset, swapped_);
  }
  template <typename T, typename To, size_t N>
  void fill(size_t offset, std::array<To, N>& to) const {
    for (size_t i = 0; i < N; ++i) to[i] = static_cast<To>(at<T>(offset + i * sizeof(T)));
  }
  [[nodiscard]] std::string text(size_t offset, size_t size) const {
    const std::string_view text = scan::as_text(bytes_.subspan(offset, size));
    return scan::printable(text.substr(0, std::min(text.find('\0'), size)));
  }

 private:
  std::span<const std::byte> bytes_;
  bool swapped_;
};

enum class Version { kNone, k1, k2 };

struct Recognised {
  Version version = Version::kNone;
  bool swapped = false;
  bool pair = false;
};

/// The size of the header comes first, in the byte order of the file.
Recognised recognise(std::span<const std::byte> head) {
  if (head.size() < kHeader1) return {};
  for (const bool swapped : {false, true}) {
    const auto size = scan::load<uint32_t>(head.data(), swapped);
    const std::string_view magic1 = scan::as_text(head.subspan(344, 4));
    const std::string_view magic2 = scan::as_text(head.subspan(4, 4));
    if (size == kHeader1 && (magic1 == std::string_view("n+1\0", 4) || magic1 == std::string_view("ni1\0", 4))) {
      return {Version::k1, swapped, magic1[1] == 'i'};
    }
    if (size == kHeader2 && (magic2 == std::string_view("n+2\0", 4) || magic2 == std::string_view("ni2\0", 4))) {
      return {Version::k2, swapped, magic2[1] == 'i'};
    }
  }
  return {};
}

void read_version1(const Record& record, Fields& fields) {
  record.fill<int16_t>(40, fields.sizes);
  fields.intent = record.at<int16_t>(68);
  fields.type = record.at<int16_t>(70);
  record.fill<float>(76, fields.spacing);
  const auto offset = static_cast<double>(record.at<float>(108));
  fields.data_offset = offset >= 0 && offset < 1e15 ? static_cast<int64_t>(offset) : -1;
  fields.slope = record.at<float>(112);
  fields.intercept = record.at<float>(116);
  fields.units = record.at<uint8_t>(123);
  fields.description = record.text(148, 80);
  fields.qform = record.at<int16_t>(252);
  fields.sform = record.at<int16_t>(254);
  record.fill<float>(256, fields.quaternion);
  record.fill<float>(280, fields.rows);
}

void read_version2(const Record& record, Fields& fields) {
  fields.type = record.at<int16_t>(12);
  record.fill<int64_t>(16, fields.sizes);
  record.fill<double>(104, fields.spacing);
  fields.data_offset = record.at<int64_t>(168);
  fields.slope = record.at<double>(176);
  fields.intercept = record.at<double>(184);
  fields.description = record.text(240, 80);
  fields.qform = record.at<int32_t>(344);
  fields.sform = record.at<int32_t>(348);
  record.fill<double>(352, fields.quaternion);
  record.fill<double>(400, fields.rows);
  fields.units = record.at<int32_t>(500);
  fields.intent = record.at<int32_t>(504);
}

/// The first bytes of a file, unpacked; fewer if it is shorter.
std::vector<std::byte> head_of(const FilePtr& file) {
  std::vector<std::byte> head(kHeader2);
  const Result<size_t> size = stream::open_inflated(file)->read(head);
  head.resize(size.value_or(0));
  return head;
}

Result<Fields> read_fields(std::span<const std::byte> head) {
  const Recognised found = recognise(head);
  const size_t size = found.version == Version::k2 ? kHeader2 : kHeader1;
  if (found.version == Version::kNone || head.size() < size) {
    return fail(ErrorKind::kInvalidInput, "truncated: ends within its NIfTI header");
  }
  Fields fields;
  fields.swapped = found.swapped;
  fields.pair = found.pair;
  const Record record(head, found.swapped);
  found.version == Version::k1 ? read_version1(record, fields) : read_version2(record, fields);
  return fields;
}

Result<ScalarType> type_of(int code) {
  static constexpr std::pair<int, ScalarType> kTypes[] = {
      {2, ScalarType::kUint8},    {4, ScalarType::kInt16},     {8, ScalarType::kInt32},    {16, ScalarType::kFloat32},
      {64, ScalarType::kFloat64}, {256, ScalarType::kInt8},    {512, ScalarType::kUint16}, {768, ScalarType::kUint32},
      {1024, ScalarType::kInt64}, {1280, ScalarType::kUint64},
  };
  static constexpr std::pair<int, const char*> kOthers[] = {
      {1, "single bits"},        {32, "complex numbers"},   {128, "colours (RGB)"},   {1536, "128 bit floats"},
      {1792, "complex numbers"}, {2048, "complex numbers"}, {2304, "colours (RGBA)"},
  };
  for (const auto& [known, type] : kTypes) {
    if (known == code) return type;
  }
  for (const auto& [known, name] : kOthers) {
    if (known == code) {
      return fail(ErrorKind::kUnsupported, std::string("NIfTI: samples are ") + name + ", which are not supported");
    }
  }
  return fail(ErrorKind::kInvalidInput, "NIfTI: unknown type of samples: " + std::to_string(code));
}

SampleKind kind_of(TensorOrder order) {
  switch (order) {
    case TensorOrder::kLower:
      return SampleKind::kSymmetricTensorLower;
    case TensorOrder::kMrtrix:
      return SampleKind::kSymmetricTensorMrtrix;
    case TensorOrder::kFsl:
      break;
  }
  return SampleKind::kSymmetricTensor;
}

/// Six images along the fourth or the fifth axis, of which nothing says what they are.
tl::unexpected<Error> ask_for_order() {
  return fail(ErrorKind::kUnsupported,
              "NIfTI: six images, which may be tensors: state their order with --tensor-order (lower: xx xy yy xz yz "
              "zz, fsl: xx xy xz yy yz zz, mrtrix: xx yy zz xy xz yz)");
}

/// Dimensions: 1 to 3 space, 4 time, 5 components, which follow each other as whole images.
Status read_sizes(const Fields& fields, std::optional<TensorOrder> order, StoredGrid& grid) {
  const int64_t dimensions = fields.sizes[0];
  if (dimensions < 1 || dimensions > 7) {
    return fail(ErrorKind::kInvalidInput, "NIfTI: a grid of " + std::to_string(dimensions) + " dimensions");
  }
  std::array<int64_t, 8> sizes{1, 1, 1, 1, 1, 1, 1, 1};
  std::copy_n(fields.sizes.begin() + 1, dimensions, sizes.begin() + 1);
  if (std::any_of(sizes.begin(), sizes.end(), [](int64_t size) { return size < 0; })) {
    return fail(ErrorKind::kInvalidInput, "NIfTI: a negative size");
  }
  for (size_t axis = 0; axis < 3; ++axis) grid.header.size[axis] = static_cast<uint64_t>(sizes[axis + 1]);
  const bool stated = fields.intent == kSymmetricMatrixIntent && sizes[5] == 6;
  const bool six = std::max(sizes[4], sizes[5]) == 6 && std::min(sizes[4], sizes[5]) == 1;
  const bool tensors = stated || (six && order.has_value());
  const bool one = sizes[6] == 1 && sizes[7] == 1;
  if (six && one && !tensors) return ask_for_order();
  if (sizes[4] != 1 && !tensors) {
    return fail(ErrorKind::kUnsupported, "NIfTI: a series of " + std::to_string(sizes[4]) + " grids; one is read");
  }
  if ((sizes[5] != 1 && !tensors) || sizes[6] != 1 || sizes[7] != 1) {
    return fail(ErrorKind::kUnsupported, "NIfTI: samples of " + std::to_string(sizes[5]) +
                                             " components with the intent " + std::to_string(fields.intent) +
                                             "; only scalars and tensors (1005) are read");
  }
  grid.planar = tensors;
  if (tensors) grid.header.kind = kind_of(order.value_or(TensorOrder::kLower));
  return {};
}

/// nifti1.h, method 2: a unit quaternion with a >= 0; spacing[0] is the sign of the third axis.
glm::dmat4x3 qform_of(const Fields& fields) {
  auto [b, c, d, x, y, z] = fields.quaternion;
  double a = 1 - (b * b + c * c + d * d);
  if (a < 1e-7) {
    const double length = std::sqrt(b * b + c * c + d * d);
    b /= length;
    c /= length;
    d /= length;
    a = 0;
  } else {
    a = std::sqrt(a);
  }
  const glm::dmat3 rotation(a * a + b * b - c * c - d * d, 2 * (b * c + a * d), 2 * (b * d - a * c),
                            2 * (b * c - a * d), a * a + c * c - b * b - d * d, 2 * (c * d + a * b),
                            2 * (b * d + a * c), 2 * (c * d - a * b), a * a + d * d - b * b - c * c);
  const double sign = fields.spacing[0] < 0 ? -1 : 1;
  return affine(rotation, {fields.spacing[1], fields.spacing[2], sign * fields.spacing[3]}, {x, y, z});
}

void place(const Fields& fields, GridHeader& header) {
  if (fields.sform > 0) {
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 4; ++column) {
        header.index_to_world[column][row] = fields.rows[static_cast<size_t>(row) * 4 + static_cast<size_t>(column)];
      }
    }
    header.frame = WorldFrame::kRas;
  } else if (fields.qform > 0) {
    header.index_to_world = qform_of(fields);
    header.frame = WorldFrame::kRas;
  } else {
    const auto step = [&](size_t i) { return fields.spacing[i] == 0 ? 1.0 : fields.spacing[i]; };
    header.index_to_world = affine(glm::dmat3(1.0), {step(1), step(2), step(3)}, glm::dvec3(0));
  }
}

/// The axes of tensors of FSL: those of the grid, the first one turned if they are right-handed, as in its tables of
/// gradients.
glm::dmat3 fsl_frame(const glm::dmat4x3& index_to_world) {
  glm::dmat3 axes;
  for (int axis = 0; axis < 3; ++axis) axes[axis] = glm::normalize(index_to_world[axis]);
  if (glm::determinant(axes) > 0) axes[0] = -axes[0];
  return axes;
}

std::string length_unit(int units) {
  static constexpr const char* kUnits[] = {"", "m", "mm", "um"};
  const int code = units & 7;
  return code < 4 ? kUnits[code] : "";
}

Result<StoredGrid> describe_nifti(const Fields& fields, std::optional<TensorOrder> order) {
  StoredGrid grid;
  grid.swapped = fields.swapped;
  grid.header.format = "NIfTI";
  grid.header.name = fields.description;
  const Result<ScalarType> type = type_of(fields.type);
  if (!type) return fail(type);
  grid.header.type = *type;
  if (Status status = read_sizes(fields, order, grid); !status) return fail(status);
  place(fields, grid.header);
  if (grid.header.kind == SampleKind::kSymmetricTensor) {
    grid.header.measurement_frame = fsl_frame(grid.header.index_to_world);
  }
  grid.header.length_unit = length_unit(fields.units);
  if (fields.slope != 0 && std::isfinite(fields.slope) && std::isfinite(fields.intercept)) {
    grid.header.slope = fields.slope;
    grid.header.intercept = fields.intercept;
  }
  if (Status status = check_header(grid.header); !status) return fail(status);
  return grid;
}

/// "name.img" or "name.img.gz" beside "name.hdr" or "name.hdr.gz".
Result<std::filesystem::path> image_beside(std::filesystem::path header) {
  if (header.extension() == ".gz") header.replace_extension();
  header.replace_extension();
  for (const char* extension : {".img", ".img.gz"}) {
    std::filesystem::path path = header;
    path += extension;
    if (std::filesystem::exists(path)) return path;
  }
  return fail(ErrorKind::kNotFound, "NIfTI: the image (.img) beside this header is missing");
}

}  // namespace

bool looks_like_nifti(std::span<const std::byte> head) {
  return recognise(head).version != Version::kNone;
}

bool looks_like_packed_nifti(const FilePtr& file) {
  return stream::is_gzip(file->bytes()) && looks_like_nifti(head_of(file));
}

Result<StoredGrid> parse_nifti(const GridFile& file) {
  const Result<Fields> fields = read_fields(head_of(file.file));
  if (!fields) return fail(fields);
  Result<StoredGrid> grid = describe_nifti(*fields, file.order);
  if (!grid) return grid;
  const Result<std::filesystem::path> path = fields->pair ? image_beside(file.path) : file.path;
  if (!path) return fail(path);
  Result<FilePtr> image = fields->pair ? stream::open_shared(*path) : Result<FilePtr>(file.file);
  if (!image) return fail(image);
  StoredSamples samples;
  samples.packing = stream::is_gzip((*image)->bytes()) ? Packing::kInflate : Packing::kRaw;
  samples.type = grid->header.type;
  samples.bytes = grid->header.samples() * grid->header.sample_bytes();
  samples.byte_skip = fields->data_offset;
  samples.file = std::move(*image);
  if (samples.byte_skip < 0) return fail(ErrorKind::kInvalidInput, "NIfTI: the place of the samples makes no sense");
  store(std::move(samples), *grid);
  if (fields->pair) {
    grid->data_files = 1;
    grid->data_file = [image = *path](uint64_t) { return image; };
  }
  return grid;
}

}  // namespace surfcast::grid
