#include <string>
#include <utility>

#include "gaussian/readers.h"
#include "scan/scalar_type.h"

namespace surfcast::gaussian {
namespace {

constexpr size_t kRecord = 32;

class SplatGaussians final : public GaussianSource {
 public:
  SplatGaussians(stream::FilePtr file, GaussianTraits traits) : file_(std::move(file)), traits_(std::move(traits)) {}

  [[nodiscard]] const GaussianTraits& traits() const override { return traits_; }

  Result<Gaussians> read(uint64_t first, uint64_t count) override {
    Gaussians gaussians = make_gaussians(count, 0);
    for (size_t i = 0; i < count; ++i) decode(file_->bytes().data() + (first + i) * kRecord, i, gaussians);
    file_->release_pages();
    return gaussians;
  }

 private:
  static void decode(const std::byte* record, size_t i, Gaussians& g) {
    const auto byte = [record](size_t at) { return static_cast<double>(record[24 + at]); };
    for (int axis = 0; axis < 3; ++axis) {
      const auto at = static_cast<size_t>(axis);
      g.positions[i][axis] = scan::load<float>(record + 4 * at);
      g.scales[i][axis] = scan::load<float>(record + 12 + 4 * at);
      g.harmonics[i * 3 + at] = coefficient_of(byte(at) / 255);
    }
    g.opacities[i] = static_cast<float>(byte(3) / 255);
    const auto part = [&](size_t at) { return static_cast<float>((byte(4 + at) - 128) / 128); };
    g.rotations[i] = glm::quat(part(0), part(1), part(2), part(3));
  }

  stream::FilePtr file_;
  GaussianTraits traits_;
};

}  // namespace

Result<SourcePtr> open_splat(const stream::FilePtr& file) {
  const size_t size = file->bytes().size();
  if (size % kRecord != 0) {
    return fail(ErrorKind::kInvalidInput,
                "truncated: its " + std::to_string(size) + " bytes are not whole records of 32");
  }
  GaussianTraits traits;
  traits.format = ".splat";
  traits.count = size / kRecord;
  return std::make_unique<SplatGaussians>(file, std::move(traits));
}

}  // namespace surfcast::gaussian
