#include <algorithm>
#include <limits>
#include <utility>
#include <vector>

#include "render/draw_to_goal.h"
#include "render/sampled_error.h"

namespace surfcast::render {
namespace {

constexpr double kReference = 0.25;     // spacing of the reference
constexpr double kReferenceLack = 0.7;  // dB: what the reference lacks itself, in the mean over six scans
constexpr int kWindowSide = 64;         // pixels, a multiple of the tiles
constexpr int kWindows = 32;            // estimates are mostly within 1.2 dB
constexpr int kSketch = 4;              // sides of a picture over those of the sketches that tell where errors are

class ErrorDrawing {
 public:
  ErrorDrawing(const picture::PictureRequest& request, const DrawWindow& draw, SpacingGuess& guess)
      : request_(request), asked_(request), draw_(draw), guess_(guess), search_(request.error) {
    request_.error = request_.time_ms = 0;
    request_.depth_texels = 0;
    request_.format = picture::PixelFormat::kSrgb8;
  }

  Result<picture::Frame> run() {
    std::optional<double> next = guessed_spacing(guess_, asked_.error);
    for (; next; next = search_.next()) {
      if (*next == 0) {
        search_.add({0, kSamePicture});
      } else if (const Status tried = try_spacing(*next); !tried) {
        return fail(tried);
      }
    }
    return finish();
  }

 private:
  struct Reference {
    SampledWindow window;
    picture::Image image;
  };

  Result<picture::Frame> draw_at(double spacing, const Region& window) {
    picture::PictureRequest request = request_;
    request.spacing = spacing;
    return draw_with(request, window);
  }

  Result<picture::Frame> draw_with(const picture::PictureRequest& request, const std::optional<Region>& window = {}) {
    Result<picture::Frame> frame = draw_(request, window);
    if (frame) spent_ms_ += drawing_ms(*frame);
    return frame;
  }

  /// Measures the error of a spacing in windows.
  Status try_spacing(double spacing) {
    const bool known =
        reference_spacing_ > 0 && spacing >= 2 * reference_spacing_ && spacing <= 16 * reference_spacing_;
    if (!known) {
      if (Status begun = begin_round(spacing); !begun) return begun;
    }
    double squares = 0;
    for (const Reference& reference : references_) {
      const Region& region = reference.window.region;
      const Result<picture::Frame> part = draw_at(spacing, region);
      if (!part) return fail(part);
      squares += reference.window.weight *
                 compare_pixels(part->image, reference.image, {0, 0, region.width, region.height}).squares;
    }
    search_.add({spacing, measured(squares)});
    return {};
  }

  /// PSNR, dB, of a picture with these squares of differences from the reference.
  [[nodiscard]] double measured(double squares) const {
    const double decibels = covered_ > 0 ? psnr_of(squares / covered_) : kSamePicture;
    return decibels < kSamePicture ? decibels - kReferenceLack : kSamePicture;
  }

  /// Chooses windows and draws what pictures of about this spacing are compared with.
  Status begin_round(double spacing) {
    const Result<picture::Frame> fine = sketch(2 * spacing);
    if (!fine) return fail(fine);
    const Result<picture::Frame> coarse = sketch(4 * spacing);
    if (!coarse) return fail(coarse);
    const ErrorSample sample =
        choose_windows(fine->image, coarse->image, request_.width, request_.height, kWindowSide, kWindows);
    covered_ = sample.covered;
    reference_spacing_ = kReference * spacing;
    references_.clear();
    for (const SampledWindow& window : sample.windows) {
      Result<picture::Frame> part = draw_at(reference_spacing_, window.region);
      if (!part) return fail(part);
      references_.push_back({window, std::move(part->image)});
    }
    return {};
  }

  /// A small picture as in motion, with the surfels of this spacing of the large one.
  Result<picture::Frame> sketch(double spacing) {
    picture::PictureRequest request = request_;
    request.width = std::max(request.width / kSketch, 1);
    request.height = std::max(request.height / kSketch, 1);
    request.spacing = spacing / kSketch;
    request.normalization = picture::Normalization::kSurfel;
    request.blends_behind = true;
    request.silhouettes = false;
    return draw_with(request);
  }

  Result<picture::Frame> finish() {
    const SpacingError found = search_.best();
    if (found.spacing > 0 && found.decibels < kSamePicture) guess_.found = found;
    picture::PictureRequest request = asked_;
    request.error = request.time_ms = 0;
    request.spacing = found.spacing;
    Result<picture::Frame> frame = draw_(request, {});
    if (!frame) return frame;
    const bool same = found.decibels == kSamePicture;
    frame->expected_error = same ? std::numeric_limits<double>::infinity() : found.decibels;
    frame->expected_ms = drawing_ms(*frame);
    frame->stats.stages.push_back({"search", spent_ms_});
    return frame;
  }

  picture::PictureRequest request_;  ///< of the pictures that are compared
  const picture::PictureRequest& asked_;
  const DrawWindow& draw_;
  SpacingGuess& guess_;
  SpacingSearch search_;
  double covered_ = 0;  ///< pixels
  double reference_spacing_ = 0;
  std::vector<Reference> references_;
  double spent_ms_ = 0;
};

}  // namespace

Result<picture::Frame> draw_to_error(const picture::PictureRequest& request, const DrawWindow& draw,
                                     SpacingGuess& guess) {
  return ErrorDrawing(request, draw, guess).run();
}

}  // namespace surfcast::render
