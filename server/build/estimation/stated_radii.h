#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "estimation/classify_points.h"
#include "estimation/neighbours.h"
#include "estimation/orient_normals.h"
#include "estimation/surface_spacing.h"
#include "surfel/surfel_cloud.h"

namespace surfcast::estimation {

/// What becomes of the radii that files state.
enum class RadiusPolicy : uint8_t {
  kAuto,      ///< scaled to the kernel where they follow the sampling, else estimated
  kKeep,      ///< as stated
  kEstimate,  ///< estimated
};

/// Whether a stated number can be a radius.
bool is_radius(float number);

/// The radii that an input states, beside those that the kernel needs there. Comparisons of parts add up to that of the
/// whole input, in any order.
class RadiusComparison {
 public:
  /// `scatter`: how many of them lie on no surface.
  void add_stated(uint64_t points, uint64_t scatter);
  void add_missing(uint64_t points, uint64_t scatter);
  /// `ratio` > 0: stated to needed.
  void add_ratio(double ratio);
  void add(const RadiusComparison& part);

  [[nodiscard]] uint64_t stated() const { return stated_; }    ///< points with a radius that is finite and positive
  [[nodiscard]] uint64_t missing() const { return missing_; }  ///< points without
  [[nodiscard]] uint64_t ratios() const;
  [[nodiscard]] uint64_t stated_scatter() const { return stated_scatter_; }
  [[nodiscard]] uint64_t missing_scatter() const { return missing_scatter_; }
  /// All counts as numbers, and the comparison that they state; none if they state none.
  [[nodiscard]] std::vector<uint64_t> numbers() const;
  static std::optional<RadiusComparison> of_numbers(std::span<const uint64_t> numbers);
  /// The ratio that a share of the ratios is below, with a relative error of at most 2^(1/128). There must be ratios.
  [[nodiscard]] double quantile(double share) const;

 private:
  static constexpr int kOctaves = 10;  ///< beyond 2^-10 and 2^10, ratios count as these
  static constexpr int kSteps = 64;    ///< per octave

  uint64_t stated_ = 0;
  uint64_t missing_ = 0;
  uint64_t stated_scatter_ = 0;
  uint64_t missing_scatter_ = 0;
  std::vector<uint64_t> histogram_;  ///< of log2(ratio); empty without ratios
};

/// Compares the stated radii of each input in a part of a cloud with `needed`, one for each site, by area: for each of
/// the part's own points, the square root of the quotient of the sums of squares of both, over the point and those of
/// the six nearest sites that state a radius in the same input. Single radii may be off; what is covered from afar is
/// the sum of areas. `inputs` has the input of each source of the cloud. An empty `needed` only counts points.
/// `kinds`: of the surfels.
std::vector<RadiusComparison> compare_radii(const surfel::SurfelCloud& cloud, std::span<const size_t> inputs,
                                            const Sites& sites, const NeighbourGraph& graph,
                                            std::span<const SitePlace> places, std::span<const PointKind> kinds,
                                            std::span<const float> needed);

/// Stated radii in units of the spacing, which the needed radius is 1.08 times (surfel/even_sampling.h).
struct RadiiInSpacings {
  double median = 0;
  double least = 0;  ///< one in twenty is smaller
  double most = 0;   ///< one in twenty is larger
};

enum class RadiusOutcome : uint8_t { kKept, kScaled, kEstimated };

/// What becomes of the radii of an input.
struct RadiusDecision {
  RadiusOutcome outcome = RadiusOutcome::kEstimated;
  uint64_t stated = 0;                     ///< points with a radius that is finite and positive
  uint64_t missing = 0;                    ///< points without; theirs are estimated, whatever the outcome
  uint64_t stated_scatter = 0;             ///< those of the stated ones that lie on no surface
  uint64_t missing_scatter = 0;            ///< and of the missing ones
  std::optional<RadiiInSpacings> stating;  ///< none: not compared
  float factor = 1;                        ///< on the stated radii, unless they are estimated

  /// Points that are drawn as scatter: those with stated radii are discs.
  [[nodiscard]] uint64_t scatter() const {
    return missing_scatter + (outcome == RadiusOutcome::kEstimated ? stated_scatter : 0);
  }
  [[nodiscard]] uint64_t estimated() const { return outcome == RadiusOutcome::kEstimated ? stated + missing : missing; }
};

/// Radii follow the sampling if the median is 0.4 to 3 spacings, and nine in ten lie within a factor of 2.5. Then one
/// factor brings the median to what the kernel needs. Fewer than 64 radii are kept, because they say too little.
RadiusDecision decide_radii(const RadiusComparison& comparison, RadiusPolicy policy);

/// One line for the report, like "radii of 0.95 spacings, scaled by 1.14".
std::string describe(const RadiusDecision& decision);

/// Sets the radii of a cloud, which has those stated or none: by the decision for the input of each source, or as
/// estimated for each surfel, within the limits of `spacing`. Tells the cloud which of the surfels with estimated radii
/// are scatter. `decisions` are those of all inputs, so that all parts of a cloud agree whether any radius comes from a
/// source.
void apply_radii(std::span<const RadiusDecision> decisions, std::span<const size_t> inputs, const Estimates& estimates,
                 const SurfaceSpacing& spacing, surfel::SurfelCloud& cloud);

}  // namespace surfcast::estimation
