#include "encode/encode_picture.h"

#include <filesystem>
#include <string>

#include <dlfcn.h>

#include "base/contract.h"
#include "encode/codec_module.h"

namespace surfcast::encode {
namespace {

/// Loads OpenImageIO with the module that uses it. The library brings some 250 others, which take longer to load than
/// everything else at start, so that commands that encode nothing do without.
Result<EncodeFunction*> load_codecs() {
  std::error_code code;
  const std::filesystem::path programs = std::filesystem::read_symlink("/proc/self/exe", code).parent_path();
  const std::string path = (programs / "../lib/surfcast" / kCodecModule).lexically_normal().string();
  void* module = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
  void* function = module != nullptr ? dlsym(module, kEncodeSymbol) : nullptr;
  if (function == nullptr) return fail(ErrorKind::kInternal, std::string("cannot load the image codecs: ") + dlerror());
  return reinterpret_cast<EncodeFunction*>(function);
}

const Result<EncodeFunction*>& codecs() {
  static const Result<EncodeFunction*> loaded = load_codecs();
  return loaded;
}

}  // namespace

Status prepare_encoding() {
  return codecs() ? Status() : fail(codecs().error());
}

Result<std::vector<std::byte>> encode_picture(const picture::Image& image, picture::FileFormat format, int quality) {
  SURFCAST_EXPECTS(image.width > 0 && image.height > 0 && image.format == picture::pixel_format_of(format));
  SURFCAST_EXPECTS(image.pixels.size() ==
                   bytes_per_pixel(image.format) * static_cast<size_t>(image.width) * image.height);
  if (!codecs()) return fail(codecs().error());
  Result<std::vector<std::byte>> bytes;
  (*codecs())(image, format, quality, bytes);
  return bytes;
}

}  // namespace surfcast::encode
