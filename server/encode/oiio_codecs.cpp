// The module that encodes pictures with OpenImageIO; encode_picture.cpp loads it.
#include <memory>
#include <string>

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include "encode/codec_module.h"

namespace surfcast::encode {
namespace {

constexpr int kChannels = 3;  // channels of a file

/// OpenImageIO's name of the writer.
const char* writer_of(picture::FileFormat format) {
  switch (format) {
    case picture::FileFormat::kJpeg:
      return "jpeg";
    case picture::FileFormat::kWebp:
      return "webp";
    case picture::FileFormat::kExr:
      return "openexr";
    case picture::FileFormat::kPng:
      break;
  }
  return "png";
}

OIIO::ImageSpec make_spec(const picture::Image& image, picture::FileFormat format, int quality) {
  const bool is_float = image.format == picture::PixelFormat::kLinearFloat;
  OIIO::ImageSpec spec(image.width, image.height, kChannels, is_float ? OIIO::TypeDesc::FLOAT : OIIO::TypeDesc::UINT8);
  spec.attribute("oiio:ColorSpace", is_float ? "Linear" : "sRGB");
  if (format == picture::FileFormat::kPng) {
    // Level 1 of zlib takes a third of the time of the default level; files are half as large again.
    spec.attribute("png:compressionLevel", 1);
  } else if (format == picture::FileFormat::kExr) {
    spec.attribute("compression", "zip:1");  // lossless; level 1 for the same reason
    // The writer would otherwise store the time of day, and equal images would not give equal bytes.
    spec.attribute("DateTime", "1970:01:01 00:00:00");
  } else {
    spec.attribute("Compression", std::string(writer_of(format)) + ":" + std::to_string(quality));
  }
  return spec;
}

tl::unexpected<Error> writer_failed(OIIO::ImageOutput& writer) {
  return fail(ErrorKind::kInternal, "cannot encode the picture: " + writer.geterror());
}

Result<std::vector<std::byte>> encode_with_oiio(const picture::Image& image, picture::FileFormat format, int quality) {
  const std::unique_ptr<OIIO::ImageOutput> writer = OIIO::ImageOutput::create(writer_of(format));
  if (!writer) return fail(ErrorKind::kInternal, std::string("no writer of ") + writer_of(format));
  std::vector<unsigned char> bytes;
  OIIO::Filesystem::IOVecOutput memory(bytes);
  if (!writer->set_ioproxy(&memory)) return writer_failed(*writer);
  const OIIO::ImageSpec spec = make_spec(image, format, quality);
  if (!writer->open(writer_of(format), spec)) return writer_failed(*writer);
  // The stride of four channels makes the writer skip the fourth.
  if (!writer->write_image(spec.format, image.pixels.data(),
                           static_cast<OIIO::stride_t>(bytes_per_pixel(image.format))) ||
      !writer->close()) {
    return writer_failed(*writer);
  }
  const auto* first = reinterpret_cast<const std::byte*>(bytes.data());
  return std::vector<std::byte>(first, first + bytes.size());
}

}  // namespace
}  // namespace surfcast::encode

void surfcast_encode_picture(const surfcast::picture::Image& image, surfcast::picture::FileFormat format, int quality,
                             surfcast::Result<std::vector<std::byte>>& bytes) {
  bytes = surfcast::encode::encode_with_oiio(image, format, quality);
}
