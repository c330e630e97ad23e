#include "client/window/decode_picture.h"

#include <memory>
#include <string>

#include <png.h>
#include <turbojpeg.h>

namespace surfcast::window {
namespace {

constexpr int kMaxSide = 16384;  // pixels

tl::unexpected<Error> unreadable(const std::string& why) {
  return fail(ErrorKind::kInvalidInput, "the server sent a picture that cannot be decoded: " + why);
}

Result<PixelImage> blank(int width, int height) {
  if (width < 1 || height < 1 || width > kMaxSide || height > kMaxSide) return unreadable("its size");
  PixelImage image{width, height, {}};
  image.pixels.resize(static_cast<size_t>(width) * static_cast<size_t>(height) * 4);
  return image;
}

Result<PixelImage> decode_png(const std::string& data) {
  png_image reader{};
  reader.version = PNG_IMAGE_VERSION;
  const std::unique_ptr<png_image, decltype(&png_image_free)> guard(&reader, png_image_free);
  if (png_image_begin_read_from_memory(&reader, data.data(), data.size()) == 0) return unreadable(reader.message);
  reader.format = PNG_FORMAT_BGRA;
  Result<PixelImage> image = blank(static_cast<int>(std::min<uint32_t>(reader.width, kMaxSide + 1)),
                                   static_cast<int>(std::min<uint32_t>(reader.height, kMaxSide + 1)));
  if (!image) return image;
  if (png_image_finish_read(&reader, nullptr, image->pixels.data(), image->width * 4, nullptr) == 0) {
    return unreadable(reader.message);
  }
  return image;
}

Result<PixelImage> decode_jpeg(const std::string& data) {
  const std::unique_ptr<void, decltype(&tjDestroy)> reader(tjInitDecompress(), tjDestroy);
  const auto* bytes = reinterpret_cast<const unsigned char*>(data.data());
  int width = 0;
  int height = 0;
  int subsampling = 0;
  int colours = 0;
  if (tjDecompressHeader3(reader.get(), bytes, data.size(), &width, &height, &subsampling, &colours) != 0) {
    return unreadable(tjGetErrorStr2(reader.get()));
  }
  Result<PixelImage> image = blank(width, height);
  if (!image) return image;
  if (tjDecompress2(reader.get(), bytes, data.size(), image->pixels.data(), width, 0, height, TJPF_BGRX, 0) != 0) {
    return unreadable(tjGetErrorStr2(reader.get()));
  }
  return image;
}

}  // namespace

Result<PixelImage> decode_picture(const wire::Picture& picture) {
  switch (picture.format()) {
    case wire::FILE_FORMAT_PNG:
      return decode_png(picture.data());
    case wire::FILE_FORMAT_JPEG:
      return decode_jpeg(picture.data());
    default:
      return unreadable("it is neither PNG nor JPEG");
  }
}

}  // namespace surfcast::window
