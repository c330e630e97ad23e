#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "gaussian/readers.h"
#include "gaussian/sog_meta.h"
#include "gaussian/sog_picture.h"
#include "scan/text_tokens.h"

namespace surfcast::gaussian {
namespace {

/// Entries of the palette in a row of its picture.
constexpr uint64_t kPaletteRow = 64;
/// Alpha of a rotation whose w is left out.
constexpr int kFirstRotation = 252;

/// Beyond the Gaussians, pictures have some pixels that fill their last rows.
constexpr uint64_t most_pixels(uint64_t count) {
  return 2 * count + 65536;
}

struct SogPictures {
  SogPicture means_low;
  SogPicture means_high;
  SogPicture scales;
  SogPicture quats;
  SogPicture colors;
  SogPicture centroids;
  SogPicture labels;

  [[nodiscard]] uint64_t bytes() const {
    return means_low.bytes.size() + means_high.bytes.size() + scales.bytes.size() + quats.bytes.size() +
           colors.bytes.size() + centroids.bytes.size() + labels.bytes.size();
  }
};

/// Decodes pictures one after another, within a limit.
class PictureLoader {
 public:
  PictureLoader(const FetchFile& fetch, const scan::DecodingLimit& limit) : fetch_(fetch), limit_(limit) {}

  /// A picture with at least one pixel for each Gaussian.
  Status load(const std::string& name, uint64_t count, SogPicture& into) {
    return load_if(name, into, [count](const SogPicture& size) -> Status {
      if (size.pixels() >= count && size.pixels() <= most_pixels(count)) return {};
      return fail(ErrorKind::kInvalidInput,
                  std::to_string(size.pixels()) + " pixels are not those of " + std::to_string(count) + " Gaussians");
    });
  }

  Status load_palette(const SogPalette& palette, SogPicture& into) {
    const uint64_t width = kPaletteRow * (harmonics_of(palette.degree) - 1);
    const uint64_t rows = (palette.count + kPaletteRow - 1) / kPaletteRow;
    return load_if(palette.centroids, into, [&](const SogPicture& size) -> Status {
      if (size.width == width && size.height >= rows && size.pixels() <= most_pixels(width * rows)) return {};
      return fail(ErrorKind::kInvalidInput, std::to_string(size.width) + " x " + std::to_string(size.height) +
                                                " pixels are not those of " + std::to_string(palette.count) +
                                                " palette entries");
    });
  }

 private:
  template <typename Check>
  Status load_if(const std::string& name, SogPicture& into, Check&& check) {
    const Result<std::vector<std::byte>> file = fetch_(name);
    if (!file) return fail(file);
    const auto named = [&name](const Error& e) { return fail(e.kind, scan::printable(name) + ": " + e.message); };
    const Result<SogPicture> size = webp_size(*file);
    if (!size) return named(size.error());
    if (Status status = check(*size); !status) return named(status.error());
    // The decoder takes as much again as the picture.
    if (Status status = limit_.check(held_ + 8 * size->pixels()); !status) return named(status.error());
    Result<SogPicture> picture = decode_webp(*file);
    if (!picture) return named(picture.error());
    into = std::move(*picture);
    held_ += into.bytes.size();
    return {};
  }

  const FetchFile& fetch_;
  scan::DecodingLimit limit_;
  uint64_t held_ = 0;
};

uint64_t label_at(const SogPicture& labels, uint64_t i) {
  return labels.pixel(i)[0] + uint64_t{256} * labels.pixel(i)[1];
}

/// Every label must be an entry of the palette, every rotation of a known kind.
Status check_codes(const SogMeta& meta, const SogPictures& pictures) {
  for (uint64_t i = 0; i < meta.count; ++i) {
    if (pictures.quats.pixel(i)[3] < kFirstRotation) {
      return fail(ErrorKind::kInvalidInput, scan::printable(meta.quats) + ": damaged: rotation " + std::to_string(i) +
                                                " does not say which part is left out");
    }
    if (meta.palette && label_at(pictures.labels, i) >= meta.palette->count) {
      return fail(ErrorKind::kInvalidInput, scan::printable(meta.palette->labels) + ": damaged: label " +
                                                std::to_string(label_at(pictures.labels, i)) +
                                                " beyond the palette of " + std::to_string(meta.palette->count));
    }
  }
  return {};
}

Result<SogPictures> load_pictures(const SogMeta& meta, const FetchFile& fetch, const scan::DecodingLimit& limit) {
  PictureLoader loader(fetch, limit);
  SogPictures pictures;
  for (const auto& [name, into] : {std::pair{&meta.means_low, &pictures.means_low},
                                   {&meta.means_high, &pictures.means_high},
                                   {&meta.scale_codes, &pictures.scales},
                                   {&meta.quats, &pictures.quats},
                                   {&meta.color_codes, &pictures.colors}}) {
    if (Status status = loader.load(*name, meta.count, *into); !status) return fail(status);
  }
  if (meta.palette) {
    Status status = loader.load_palette(*meta.palette, pictures.centroids);
    if (status) status = loader.load(meta.palette->labels, meta.count, pictures.labels);
    if (!status) return fail(status);
  }
  if (Status status = check_codes(meta, pictures); !status) return fail(status);
  return pictures;
}

/// 16 bits from two pictures, on a scale that is logarithmic away from 0.
double position_of(uint64_t code, double min, double max) {
  const double value = min + (max - min) * static_cast<double>(code) / 65535.0;
  return std::copysign(std::exp(std::abs(value)) - 1, value);
}

/// Alpha says which of w x y z is left out; the others follow in that order.
glm::quat rotation_of(std::span<const uint8_t, 4> pixel) {
  const auto left_out = static_cast<size_t>(pixel[3] - kFirstRotation);
  std::array<float, 4> wxyz{};
  double rest = 1;
  size_t channel = 0;
  for (size_t i = 0; i < 4; ++i) {
    if (i == left_out) continue;
    const double value = (2.0 * pixel[channel++] / 255 - 1) * std::sqrt(0.5);
    wxyz[i] = static_cast<float>(value);
    rest -= value * value;
  }
  wxyz[left_out] = static_cast<float>(std::sqrt(std::max(0.0, rest)));
  return {wxyz[0], wxyz[1], wxyz[2], wxyz[3]};
}

class SogGaussians final : public GaussianSource {
 public:
  SogGaussians(SogMeta meta, SogPictures pictures) : meta_(std::move(meta)), pictures_(std::move(pictures)) {
    traits_.format = "SOG 2";
    traits_.count = meta_.count;
    traits_.degree = meta_.palette ? meta_.palette->degree : 0;
    traits_.antialiased = meta_.antialiased;
  }

  [[nodiscard]] const GaussianTraits& traits() const override { return traits_; }
  [[nodiscard]] uint64_t held_bytes() const override { return pictures_.bytes(); }

  Result<Gaussians> read(uint64_t first, uint64_t count) override {
    Gaussians gaussians = make_gaussians(count, traits_.degree);
    for (size_t i = 0; i < count; ++i) decode(first + i, i, gaussians);
    return gaussians;
  }

 private:
  void decode(uint64_t from, size_t i, Gaussians& g) const {
    const size_t width = harmonics_of(traits_.degree) * 3;
    const auto color = pictures_.colors.pixel(from);
    for (size_t k = 0; k < 3; ++k) {
      const auto axis = static_cast<int>(k);
      const uint64_t code = pictures_.means_low.pixel(from)[k] + uint64_t{256} * pictures_.means_high.pixel(from)[k];
      g.positions[i][axis] = rounded_to_float(position_of(code, meta_.min[axis], meta_.max[axis]));
      g.scales[i][axis] = static_cast<float>(std::exp(meta_.scales[pictures_.scales.pixel(from)[k]]));
      g.harmonics[i * width + k] = static_cast<float>(meta_.colors[color[k]]);
    }
    g.opacities[i] = static_cast<float>(color[3]) / 255.0F;
    g.rotations[i] = rotation_of(pictures_.quats.pixel(from));
    if (meta_.palette) decode_harmonics(label_at(pictures_.labels, from), &g.harmonics[i * width + 3]);
  }

  void decode_harmonics(uint64_t label, float* out) const {
    const uint64_t n = harmonics_of(traits_.degree) - 1;
    const uint64_t first = label / kPaletteRow * pictures_.centroids.width + label % kPaletteRow * n;
    for (uint64_t j = 0; j < n; ++j) {
      for (size_t channel = 0; channel < 3; ++channel) {
        *out++ = static_cast<float>(meta_.palette->codebook[pictures_.centroids.pixel(first + j)[channel]]);
      }
    }
  }

  SogMeta meta_;
  SogPictures pictures_;
  GaussianTraits traits_;
};

Result<SourcePtr> open_sog(std::string_view text, const FetchFile& fetch, const scan::DecodingLimit& limit) {
  Result<SogMeta> meta = parse_sog_meta(text);
  if (!meta) return fail(meta);
  Result<SogPictures> pictures = load_pictures(*meta, fetch, limit);
  if (!pictures) return fail(pictures);
  return std::make_unique<SogGaussians>(std::move(*meta), std::move(*pictures));
}

}  // namespace

Result<SourcePtr> open_sog_folder(const stream::FilePtr& meta, const std::filesystem::path& path,
                                  const scan::DecodingLimit& limit) {
  return open_sog(scan::as_text(meta->bytes()), files_in_folder(path.parent_path()), limit);
}

Result<SourcePtr> open_sog_zip(const stream::FilePtr& archive, const scan::DecodingLimit& limit) {
  const Result<FetchFile> fetch = files_in_zip(archive, limit);
  if (!fetch) return fail(fetch);
  const Result<std::vector<std::byte>> meta = (*fetch)("meta.json");
  if (!meta) return fail(meta);
  return open_sog(scan::as_text(*meta), *fetch, limit);
}

}  // namespace surfcast::gaussian
