#pragma once

#include <optional>
#include <vector>

namespace surfcast::render {

/// The time of drawing a picture of this spacing.
struct SpacingTime {
  double spacing = 0;       ///< see PictureRequest::spacing
  double milliseconds = 0;  ///< without loading blocks
};

/// The spacing at which the search for a time begins.
double first_spacing_for(const std::optional<SpacingTime>& known, double milliseconds);

/// Searches for the finest spacing whose picture is drawn in a stated time. Between two spacings the time is taken as a
/// constant for the pixels, and as much for each surfel, whose number is inverse to the square of the spacing. Coarse
/// pictures of a few large splats take longer again: where nothing fits, the fastest picture is searched.
class TimeSearch {
 public:
  /// `milliseconds`: the time asked for.
  explicit TimeSearch(double milliseconds);

  void add(const SpacingTime& point);
  /// The spacing to measure next; none: the best point is good enough, or measuring goes on for too long. Needs a
  /// point.
  [[nodiscard]] std::optional<double> next() const;
  /// The finest point that takes no more than a tenth more than asked, or than the fastest if that takes longer. Needs
  /// a point.
  [[nodiscard]] SpacingTime best() const;

 private:
  [[nodiscard]] bool fits(const SpacingTime& point) const;
  [[nodiscard]] std::optional<double> towards_faster() const;
  [[nodiscard]] std::optional<double> finer() const;
  [[nodiscard]] std::optional<double> between(const SpacingTime& fine, const SpacingTime& coarse) const;
  [[nodiscard]] double solve(const SpacingTime& fine, const SpacingTime& coarse) const;

  double asked_;
  std::vector<SpacingTime> points_;  ///< by ascending spacing
};

}  // namespace surfcast::render
