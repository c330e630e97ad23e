// The module that encodes EXR files with OpenImageIO; encode_picture.cpp loads it.
#include <algorithm>
#include <cstring>
#include <memory>

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include "encode/codec_module.h"

namespace surfcast::encode {
namespace {

constexpr int kChannels = 3;  // channels of a file

OIIO::ImageSpec make_spec(const picture::Image& image) {
  OIIO::ImageSpec spec(image.width, image.height, kChannels, OIIO::TypeDesc::FLOAT);
  spec.attribute("oiio:ColorSpace", "Linear");
  spec.attribute("compression", "zip:1");  // lossless; level 1 takes a third of the time of the default level
  // The writer would otherwise store the time of day, and equal images would not give equal bytes.
  spec.attribute("DateTime", "1970:01:01 00:00:00");
  return spec;
}

/// Adds the channels to the colours of a file.
void add_channels(const picture::Channels& channels, OIIO::ImageSpec& spec) {
  spec.channelformats.assign(kChannels, spec.format);
  for (const picture::FileChannel& channel : channels.channels) {
    spec.channelnames.push_back(channel.name);
    spec.channelformats.push_back(channel.whole_number ? OIIO::TypeDesc::UINT32 : OIIO::TypeDesc::FLOAT);
  }
  spec.nchannels = static_cast<int>(spec.channelnames.size());
  const OIIO::TypeDesc vector(OIIO::TypeDesc::DOUBLE, OIIO::TypeDesc::VEC3);
  spec.attribute("surfcast:origin", vector, &channels.origin.x);
}

/// The colours and the channels of rows, all channels of a pixel together. Every value has four bytes.
std::vector<uint32_t> rows_of(const picture::Image& image, const picture::Channels& channels, int first, int end) {
  const size_t count = channels.channels.size();
  std::vector<uint32_t> rows;
  const auto at = [&](int row) { return static_cast<size_t>(row) * static_cast<size_t>(image.width); };
  rows.resize((at(end) - at(first)) * (kChannels + count));
  uint32_t* to = rows.data();
  for (size_t pixel = at(first); pixel < at(end); ++pixel) {
    std::memcpy(to, image.pixels.data() + pixel * bytes_per_pixel(image.format), kChannels * sizeof *to);
    std::memcpy(to + kChannels, channels.words.data() + pixel * count, count * sizeof *to);
    to += kChannels + count;
  }
  return rows;
}

/// Writes a bounded number of rows at a time.
bool write_with_channels(OIIO::ImageOutput& writer, const picture::Image& image, const picture::Channels& channels) {
  constexpr int kRows = 64;
  for (int first = 0; first < image.height; first += kRows) {
    const int end = std::min(first + kRows, image.height);
    const std::vector<uint32_t> rows = rows_of(image, channels, first, end);
    if (!writer.write_scanlines(first, end, 0, OIIO::TypeDesc::UNKNOWN, rows.data())) return false;
  }
  return true;
}

bool write_pixels(OIIO::ImageOutput& writer, const OIIO::ImageSpec& spec, const picture::Image& image,
                  const picture::Channels* channels) {
  if (channels != nullptr) return write_with_channels(writer, image, *channels);
  // The stride of four channels makes the writer skip the fourth.
  return writer.write_image(spec.format, image.pixels.data(),
                            static_cast<OIIO::stride_t>(bytes_per_pixel(image.format)));
}

tl::unexpected<Error> writer_failed(OIIO::ImageOutput& writer) {
  return fail(ErrorKind::kInternal, "cannot encode the picture: " + writer.geterror());
}

Result<std::vector<std::byte>> encode_exr(const picture::Image& image, const picture::Channels* channels) {
  constexpr const char* kWriter = "openexr";
  const std::unique_ptr<OIIO::ImageOutput> writer = OIIO::ImageOutput::create(kWriter);
  if (!writer) return fail(ErrorKind::kInternal, "OpenImageIO has no writer of EXR");
  std::vector<unsigned char> bytes;
  OIIO::Filesystem::IOVecOutput memory(bytes);
  if (!writer->set_ioproxy(&memory)) return writer_failed(*writer);
  OIIO::ImageSpec spec = make_spec(image);
  if (channels != nullptr) add_channels(*channels, spec);
  if (!writer->open(kWriter, spec)) return writer_failed(*writer);
  if (!write_pixels(*writer, spec, image, channels) || !writer->close()) return writer_failed(*writer);
  const auto* first = reinterpret_cast<const std::byte*>(bytes.data());
  return std::vector<std::byte>(first, first + bytes.size());
}

}  // namespace
}  // namespace surfcast::encode

void surfcast_encode_exr(const surfcast::picture::Image& image, const surfcast::picture::Channels* channels,
                         surfcast::Result<std::vector<std::byte>>& bytes) {
  bytes = surfcast::encode::encode_exr(image, channels);
}
