#include "gaussian/gaussian_reader.h"

#include <algorithm>
#include <utility>

#include "gaussian/gaussian_format.h"
#include "gaussian/readers.h"

namespace surfcast::gaussian {
namespace {

Result<SourcePtr> open_source(GaussianFormat format, const stream::FilePtr& file, const std::filesystem::path& path,
                              const scan::DecodingLimit& limit) {
  switch (format) {
    case GaussianFormat::kPly:
      return open_ply(file);
    case GaussianFormat::kCompressedPly:
      return open_compressed_ply(file);
    case GaussianFormat::kSplat:
      return open_splat(file);
    case GaussianFormat::kSpz:
      return open_spz(file);
    case GaussianFormat::kSogMeta:
      return open_sog_folder(file, path, limit);
    case GaussianFormat::kSogZip:
      break;
  }
  return open_sog_zip(file, limit);
}

}  // namespace

Result<GaussianReader> GaussianReader::open(const std::filesystem::path& path, const scan::DecodingLimit& limit) {
  const std::filesystem::path content = std::filesystem::is_directory(path) ? path / "meta.json" : path;
  const Result<stream::FilePtr> file = stream::open_shared(content);
  if (!file) return fail(file);
  const auto error = [&](const Error& e) { return fail(e.kind, content.string() + ": " + e.message); };
  if ((*file)->bytes().empty()) return error({ErrorKind::kInvalidInput, "the file is empty"});
  const std::optional<GaussianFormat> format = gaussian_format_of(*file, content);
  if (!format) return error({ErrorKind::kUnsupported, "not a model of Gaussians of a supported format"});
  Result<SourcePtr> source = open_source(*format, *file, content, limit);
  if (!source) return error(source.error());
  return GaussianReader(content, std::move(*source));
}

Result<Gaussians> GaussianReader::read(uint64_t count) {
  const uint64_t wanted = std::min(count, traits().count - position_);
  Result<Gaussians> gaussians = source_->read(position_, wanted);
  if (!gaussians) {
    return fail_about(path_.string(), gaussians);
  }
  position_ += wanted;
  keep_usable(*gaussians);
  return gaussians;
}

}  // namespace surfcast::gaussian
