#pragma once

#include <optional>
#include <vector>

namespace surfcast::render {

/// The error of a picture of this spacing.
struct SpacingError {
  double spacing = 0;   ///< see PictureRequest::spacing
  double decibels = 0;  ///< PSNR; at most kSamePicture
};

/// The PSNR that stands for equal pictures, dB: a difference of one level in one pixel of 2^25 or so.
inline constexpr double kSamePicture = 120;

/// A point of the curve of errors over spacings from which a search begins. By default a typical scan at 1280 x 720.
struct SpacingGuess {
  SpacingError found{1.4, 40};
};

/// The spacing at which a picture has an error, if its curve passes through the guess and is as steep as usual.
double guessed_spacing(const SpacingGuess& guess, double decibels);

/// Searches for the spacing of a stated error. The PSNR falls with the spacing, by about 10 dB when it doubles; neither
/// the place nor the slope of the curve is known beforehand. Few trials, because each one is a picture: a PSNR from the
/// asked one to 2.5 dB above it is taken.
class SpacingSearch {
 public:
  /// `decibels`: the PSNR asked for.
  explicit SpacingSearch(double decibels);

  /// A measured point of the curve. The spacing 0 always has the error kSamePicture.
  void add(const SpacingError& point);
  /// The spacing to measure next; none: the best point is good enough, or measuring goes on for too long. Needs a
  /// point.
  [[nodiscard]] std::optional<double> next() const;
  /// The point nearest to the error asked for, where too large an error counts twice. Needs a point.
  [[nodiscard]] SpacingError best() const;

 private:
  [[nodiscard]] std::optional<double> between(const SpacingError& fine, const SpacingError& coarse) const;
  [[nodiscard]] double beyond(const SpacingError& end) const;
  [[nodiscard]] double miss(const SpacingError& point) const;

  double target_;
  std::vector<SpacingError> points_;  ///< by ascending spacing
};

}  // namespace surfcast::render
