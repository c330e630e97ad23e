// The module that decodes textures with OpenImageIO; texture.cpp loads it.
#include <algorithm>
#include <exception>
#include <memory>
#include <string>
#include <vector>

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include "mesh/decoder_module.h"

namespace surfcast::mesh {
namespace {

/// Grey becomes colour, and what has no alpha is opaque.
Texture texture_of(const std::vector<uint8_t>& values, int64_t width, int64_t height, size_t channels) {
  Texture texture{width, height, {}};
  texture.texels.resize(static_cast<size_t>(width * height));
  for (size_t i = 0; i < texture.texels.size(); ++i) {
    const uint8_t* from = values.data() + i * channels;
    const bool grey = channels < 3;
    const uint8_t alpha = channels == 2 ? from[1] : channels == 4 ? from[3] : uint8_t{255};
    texture.texels[i] = {from[0], grey ? from[0] : from[1], grey ? from[0] : from[2], alpha};
  }
  return texture;
}

tl::unexpected<Error> undecodable(OIIO::ImageInput& input) {
  std::string why = input.geterror();
  why.erase(std::remove_if(why.begin(), why.end(), [](unsigned char c) { return c < ' '; }), why.end());
  constexpr size_t kMax = 200;
  return fail(ErrorKind::kInvalidInput, "cannot be decoded" + (why.empty() ? why : ": " + why.substr(0, kMax)));
}

Result<Texture> decode(std::span<const std::byte> bytes, const std::string& reader, const SizeCheck& check) {
  const std::unique_ptr<OIIO::ImageInput> input = OIIO::ImageInput::create(reader);
  if (!input) return fail(ErrorKind::kUnavailable, "cannot be decoded: no reader for " + reader);
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-const-cast): the memory is only read
  OIIO::Filesystem::IOMemReader memory(const_cast<std::byte*>(bytes.data()), bytes.size());
  OIIO::ImageSpec config;
  config.attribute("oiio:UnassociatedAlpha", 1);
  OIIO::ImageSpec spec;
  if (!input->set_ioproxy(&memory) || !input->open("memory." + reader, spec, config)) return undecodable(*input);
  const auto channels = static_cast<size_t>(std::clamp(spec.nchannels, 0, 4));
  const auto width = static_cast<uint64_t>(std::max(spec.width, 0));
  const auto height = static_cast<uint64_t>(std::max(spec.height, 0));
  if (Status status = check(width, height); !status) return fail(status);
  std::vector<uint8_t> values(width * height * channels);
  if (channels == 0 || spec.depth > 1 ||
      !input->read_image(0, 0, 0, static_cast<int>(channels), OIIO::TypeDesc::UINT8, values.data())) {
    return undecodable(*input);
  }
  return texture_of(values, spec.width, spec.height, channels);
}

}  // namespace
}  // namespace surfcast::mesh

void surfcast_decode_image(std::span<const std::byte> bytes, const char* reader, const surfcast::mesh::SizeCheck& check,
                           surfcast::Result<surfcast::mesh::Texture>& texture) try {
  texture = surfcast::mesh::decode(bytes, reader, check);
} catch (const std::exception&) {
  texture = surfcast::fail(surfcast::ErrorKind::kInvalidInput, "cannot be decoded");
}
