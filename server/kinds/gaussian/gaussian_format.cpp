#include "gaussian/gaussian_format.h"

#include "gaussian/readers.h"
#include "gaussian/sog_meta.h"
#include "scan/text_tokens.h"

namespace surfcast::gaussian {

std::optional<GaussianFormat> gaussian_format_of(const stream::FilePtr& file, const std::filesystem::path& path) {
  const std::string_view text = scan::as_text(file->bytes());
  if (text.starts_with("ply")) {
    const PlyKind kind = ply_kind_of(file->bytes());
    if (kind == PlyKind::kOther) return std::nullopt;
    return kind == PlyKind::kFloats ? GaussianFormat::kPly : GaussianFormat::kCompressedPly;
  }
  if (text.starts_with("PK\3\4")) return GaussianFormat::kSogZip;
  if (looks_like_spz(file)) return GaussianFormat::kSpz;
  if (path.extension() == ".splat") return GaussianFormat::kSplat;
  if (looks_like_sog_meta(text)) return GaussianFormat::kSogMeta;
  return std::nullopt;
}

}  // namespace surfcast::gaussian
