#include "encode/frame_codecs.h"

#include <csetjmp>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include <png.h>
#include <turbojpeg.h>
#include <webp/encode.h>

namespace surfcast::encode {
namespace {

constexpr size_t kBytesPerPixel = 4;

const uint8_t* pixels_of(const picture::Image& image) {
  return reinterpret_cast<const uint8_t*>(image.pixels.data());
}

tl::unexpected<Error> cannot_encode(const std::string& why) {
  return fail(ErrorKind::kInternal, "cannot encode the picture: " + why);
}

std::vector<std::byte> copy_of(std::span<const uint8_t> bytes) {
  const auto* first = reinterpret_cast<const std::byte*>(bytes.data());
  return {first, first + bytes.size()};
}

/// The file that libpng writes, and the reason if it fails.
struct PngFile {
  std::vector<std::byte> bytes;
  std::string error;
};

void append_png(png_structp png, png_bytep data, size_t size) {
  std::vector<std::byte>& bytes = static_cast<PngFile*>(png_get_io_ptr(png))->bytes;
  const auto* first = reinterpret_cast<const std::byte*>(data);
  bytes.insert(bytes.end(), first, first + size);
}

void fail_png(png_structp png, png_const_charp message) {
  static_cast<PngFile*>(png_get_error_ptr(png))->error = message;
  png_longjmp(png, 1);
}

/// False after an error. Has no objects with destructors, because libpng leaves it by longjmp().
bool write_png(png_structp png, png_infop info, const picture::Image& image) {
  // NOLINTNEXTLINE(cert-err52-cpp): libpng reports errors in this way only
  if (setjmp(png_jmpbuf(png)) != 0) return false;
  png_set_IHDR(png, info, static_cast<png_uint_32>(image.width), static_cast<png_uint_32>(image.height), 8,
               PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_set_sRGB(png, info, PNG_sRGB_INTENT_PERCEPTUAL);
  // Pictures of this renderer: half the time of libpng's own choice of filters, and no larger.
  png_set_compression_level(png, 1);
  png_set_filter(png, PNG_FILTER_TYPE_BASE, PNG_FILTER_AVG);
  png_write_info(png, info);
  png_set_filler(png, 0, PNG_FILLER_AFTER);
  const size_t row_bytes = kBytesPerPixel * static_cast<size_t>(image.width);
  for (int y = 0; y < image.height; ++y) png_write_row(png, pixels_of(image) + static_cast<size_t>(y) * row_bytes);
  png_write_end(png, nullptr);
  return true;
}

struct EndTurboJpeg {
  void operator()(void* encoder) const { tjDestroy(encoder); }
};
struct FreeJpeg {
  void operator()(uint8_t* bytes) const { tjFree(bytes); }
};

}  // namespace

Result<std::vector<std::byte>> encode_png(const picture::Image& image) {
  PngFile file;
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &file, fail_png, nullptr);
  if (png == nullptr) return cannot_encode("libpng has another version");
  png_infop info = png_create_info_struct(png);
  png_set_write_fn(png, &file, append_png, nullptr);
  const bool written = info != nullptr && write_png(png, info, image);
  png_destroy_write_struct(&png, &info);
  if (!written) return cannot_encode(file.error);
  return std::move(file.bytes);
}

Result<std::vector<std::byte>> encode_jpeg(const picture::Image& image, int quality, picture::JpegOrder order) {
  const std::unique_ptr<void, EndTurboJpeg> encoder(tjInitCompress());
  if (!encoder) return cannot_encode(tjGetErrorStr2(nullptr));
  uint8_t* bytes = nullptr;
  unsigned long size = 0;  // NOLINT(google-runtime-int): the type of the library
  const int flags = TJFLAG_ACCURATEDCT | (order == picture::JpegOrder::kScans ? TJFLAG_PROGRESSIVE : 0);
  const int code = tjCompress2(encoder.get(), pixels_of(image), image.width, 0, image.height, TJPF_RGBX, &bytes, &size,
                               TJSAMP_420, quality, flags);
  const std::unique_ptr<uint8_t, FreeJpeg> owner(bytes);
  if (code != 0) return cannot_encode(tjGetErrorStr2(encoder.get()));
  return copy_of({bytes, size});
}

Result<std::vector<std::byte>> encode_webp(const picture::Image& image, int quality) {
  WebPConfig config;
  WebPPicture picture;
  if (WebPConfigInit(&config) == 0 || WebPPictureInit(&picture) == 0)
    return cannot_encode("libwebp has another version");
  config.quality = static_cast<float>(quality);
  config.method = 6;  // the smallest files
  picture.width = image.width;
  picture.height = image.height;
  WebPMemoryWriter file;
  WebPMemoryWriterInit(&file);
  picture.writer = WebPMemoryWrite;
  picture.custom_ptr = &file;
  const int row_bytes = static_cast<int>(kBytesPerPixel) * image.width;
  const bool written =
      WebPPictureImportRGBX(&picture, pixels_of(image), row_bytes) != 0 && WebPEncode(&config, &picture) != 0;
  std::vector<std::byte> bytes = copy_of({file.mem, file.size});
  WebPMemoryWriterClear(&file);
  WebPPictureFree(&picture);
  if (!written) return cannot_encode("error " + std::to_string(picture.error_code) + " of libwebp");
  return bytes;
}

}  // namespace surfcast::encode
