#include "mesh/texture.h"

#include <algorithm>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include <dlfcn.h>
#include <webp/decode.h>

#include "base/ascii_text.h"
#include "base/mapped_file.h"
#include "mesh/decoder_module.h"
#include "scan/text_tokens.h"

namespace surfcast::mesh {
namespace {

using Bytes = std::span<const std::byte>;

bool is_webp(std::string_view head) {
  return head.starts_with("RIFF") && head.substr(std::min<size_t>(8, head.size())).starts_with("WEBP");
}

/// OpenImageIO's name of the reader; empty if the content is of no format that is read. Targa has no signature.
std::string reader_of(std::string_view head, const std::filesystem::path& file) {
  if (head.starts_with("\x89PNG")) return "png";
  if (head.starts_with("\xFF\xD8\xFF")) return "jpeg";
  if (head.starts_with("BM")) return "bmp";
  if (head.starts_with(std::string_view("II\x2A\0", 4)) || head.starts_with(std::string_view("MM\0\x2A", 4))) {
    return "tiff";
  }
  return lower_extension(file) == ".tga" ? "targa" : "";
}

Status check_size(uint64_t width, uint64_t height, const scan::DecodingLimit& limit) {
  constexpr uint64_t kMaxSide = 65536;
  if (width == 0 || height == 0 || width > kMaxSide || height > kMaxSide) {
    return fail(ErrorKind::kInvalidInput, "has " + std::to_string(width) + " x " + std::to_string(height) + " pixels");
  }
  return limit.check(width * height * 8);
}

/// OpenImageIO would multiply colours by alpha.
Result<Texture> decode_webp(Bytes bytes, const scan::DecodingLimit& limit) {
  WebPBitstreamFeatures features;
  const auto* data = reinterpret_cast<const uint8_t*>(bytes.data());
  if (WebPGetFeatures(data, bytes.size(), &features) != VP8_STATUS_OK || features.has_animation != 0) {
    return fail(ErrorKind::kInvalidInput, "is no WebP image");
  }
  const auto width = static_cast<uint64_t>(features.width);
  const auto height = static_cast<uint64_t>(features.height);
  if (Status status = check_size(width, height, limit); !status) return fail(status);
  Texture texture{features.width, features.height, {}};
  texture.texels.resize(width * height);
  auto* out = reinterpret_cast<uint8_t*>(texture.texels.data());
  if (WebPDecodeRGBAInto(data, bytes.size(), out, texture.texels.size() * 4, features.width * 4) == nullptr) {
    return fail(ErrorKind::kInvalidInput, "is truncated or damaged");
  }
  return texture;
}

/// Loads the module that uses OpenImageIO, which depends on some 250 libraries (see encode/encode_picture.cpp).
Result<DecodeFunction*> load_decoders() {
  std::error_code code;
  const std::filesystem::path programs = std::filesystem::read_symlink("/proc/self/exe", code).parent_path();
  const std::string path = (programs / "../lib/surfcast" / kDecoderModule).lexically_normal().string();
  void* module = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
  void* function = module != nullptr ? dlsym(module, kDecodeSymbol) : nullptr;
  if (function == nullptr)
    return fail(ErrorKind::kInternal, std::string("cannot load the image decoders: ") + dlerror());
  return reinterpret_cast<DecodeFunction*>(function);
}

Result<Texture> decode(Bytes bytes, const std::string& reader, const scan::DecodingLimit& limit) {
  static const Result<DecodeFunction*> decoders = load_decoders();
  if (!decoders) return fail(decoders);
  Result<Texture> texture = fail(ErrorKind::kInternal, "cannot be decoded");
  const SizeCheck check = [&limit](uint64_t width, uint64_t height) { return check_size(width, height, limit); };
  (*decoders)(bytes, reader.c_str(), check, texture);
  return texture;
}

}  // namespace

Result<Texture> read_texture(const ImageSource& image, const scan::DecodingLimit& limit) {
  if (image.unavailable) return fail(ErrorKind::kInvalidInput, *image.unavailable);
  std::optional<MappedFile> file;
  if (!image.file.empty()) {
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(image.file, ignored)) return fail(ErrorKind::kNotFound, "is not there");
    Result<MappedFile> opened = MappedFile::open(image.file);
    if (!opened) return fail(ErrorKind::kNotFound, "cannot be read");
    file = std::move(*opened);
  }
  const Bytes bytes = file ? file->bytes() : image.bytes;
  const std::string_view head = scan::as_text(bytes);
  if (is_webp(head)) return decode_webp(bytes, limit);
  const std::string reader = reader_of(head, image.file);
  if (reader.empty()) return fail(ErrorKind::kUnsupported, "is of a format that is not read");
  return decode(bytes, reader, limit);
}

int64_t wrapped(int64_t index, int64_t size, Wrap wrap) {
  if (wrap == Wrap::kClamp) return std::clamp<int64_t>(index, 0, size - 1);
  const int64_t period = wrap == Wrap::kMirror ? 2 * size : size;
  const int64_t inside = ((index % period) + period) % period;
  return inside < size ? inside : period - 1 - inside;
}

}  // namespace surfcast::mesh
