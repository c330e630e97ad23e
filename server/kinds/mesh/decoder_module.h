#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>

#include "base/result.h"
#include "mesh/texels.h"

namespace surfcast::mesh {

/// The file of the module, in the folder lib/surfcast beside the program's folder.
inline constexpr const char* kDecoderModule = "image_decoders.so";
/// The function that the module exports.
inline constexpr const char* kDecodeSymbol = "surfcast_decode_image";
/// Whether an image of that size may be decoded.
using SizeCheck = std::function<Status(uint64_t width, uint64_t height)>;
/// `reader`: OpenImageIO's name of the format.
using DecodeFunction = void(std::span<const std::byte> bytes, const char* reader, const SizeCheck& check,
                            Result<Texture>& texture);

}  // namespace surfcast::mesh

/// Exported by the module.
extern "C" [[gnu::visibility("default")]] surfcast::mesh::DecodeFunction surfcast_decode_image;
