// Fields of scattered samples on their lattices, against the sum over all samples in double precision.

#include "scattered/field_planes.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include "scattered/scattered_reference.h"

namespace surfcast::scattered {
namespace {

using surfcast::testing::random_samples;
using surfcast::testing::reference_field;
using surfcast::testing::StatedField;
using surfcast::testing::StatedKernel;
using surfcast::testing::StatedSample;

Samples samples_of(const std::vector<StatedSample>& stated, StatedKernel kernel, StatedField field) {
  Samples samples;
  samples.profile = kernel == StatedKernel::kSpline ? Profile::kSpline : Profile::kGaussian;
  for (const StatedSample& s : stated) {
    const double c = s.size * s.size;
    const glm::dmat3& m = s.covariance;
    KernelSample sample{s.place, {c, 0, 0, c, 0, c}, s.value, 1};
    if (kernel == StatedKernel::kCovariance) sample.shape = {m[0][0], m[1][0], m[2][0], m[1][1], m[2][1], m[2][2]};
    if (field == StatedField::kDensity) {
      sample.amplitude /= integral_of(samples.profile) * std::sqrt(glm::determinant(sample.shape.matrix()));
    }
    samples.kernels.push_back(sample);
  }
  return samples;
}

Combining combining_of(StatedField field) {
  constexpr std::array kCombinations{Combination::kSum, Combination::kAverage, Combination::kDensity};
  return {kCombinations.at(static_cast<size_t>(field)), 0, kMinWeight};
}

std::vector<float> evaluated(const FieldPlanes& field, const FieldLattice& lattice) {
  std::vector<float> values(lattice.samples());
  size_t at = 0;
  for (uint32_t slab = 0; slab < field.slabs(); ++slab) {
    const size_t size = size_t{lattice.size.x} * lattice.size.y * field.planes_of(slab);
    field.evaluate(slab, std::span(values).subspan(at, size));
    at += size;
  }
  EXPECT_EQ(at, values.size());
  return values;
}

/// The largest difference to the reference, at every seventh sample of the lattice, in units of the largest value.
double largest_error(const std::vector<StatedSample>& stated, StatedKernel kernel, StatedField field,
                     const FieldLattice& lattice, const std::vector<float>& values) {
  double error = 0;
  double largest = 0;
  for (size_t i = 0; i < values.size(); i += 7) {
    const glm::dvec3 index(i % lattice.size.x, i / lattice.size.x % lattice.size.y,
                           i / (size_t{lattice.size.x} * lattice.size.y));
    const double expected = reference_field(stated, kernel, field, lattice.origin + lattice.step * index);
    error = std::max(error, std::abs(static_cast<double>(values[i]) - expected));
    largest = std::max(largest, std::abs(expected));
  }
  return error / largest;
}

TEST(FieldPlanesTest, EveryFieldIsTheSumOfItsKernels) {
  const std::vector<StatedSample> stated = random_samples(40, 1, 0.15, 0.25, 1);
  for (const StatedKernel kernel : {StatedKernel::kSpline, StatedKernel::kGaussian, StatedKernel::kCovariance}) {
    for (const StatedField field : {StatedField::kSum, StatedField::kAverage, StatedField::kDensity}) {
      const Samples samples = samples_of(stated, kernel, field);
      const Result<FieldLattice> lattice = plan_lattice(samples, Combination::kSum, {}, 1 << 16);
      ASSERT_TRUE(lattice);
      const FieldPlanes planes(samples, *lattice, combining_of(field));
      EXPECT_EQ(planes.levels(), 1U);
      const double error = largest_error(stated, kernel, field, *lattice, evaluated(planes, *lattice));
      // A Gaussian ends at 4.5 deviations, where it is 4e-5; an average divides that by 0.1 at least.
      const double bound = kernel == StatedKernel::kSpline ? 1e-6 : (field == StatedField::kAverage ? 2e-3 : 2e-4);
      EXPECT_LE(error, bound) << static_cast<int>(kernel) << " " << static_cast<int>(field);
    }
  }
}

TEST(FieldPlanesTest, WideKernelsComeFromCoarserLattices) {
  const std::vector<StatedSample> stated = random_samples(60, 1, 0.03, 1, 2);
  for (const StatedKernel kernel : {StatedKernel::kSpline, StatedKernel::kGaussian, StatedKernel::kCovariance}) {
    const Samples samples = samples_of(stated, kernel, StatedField::kSum);
    FieldLattice lattice;
    lattice.origin = glm::dvec3(-1.37, -1.21, -1.4);
    lattice.step = 0.03;
    lattice.size = {91, 83, 94};
    const FieldPlanes planes(samples, lattice, combining_of(StatedField::kSum));
    EXPECT_GE(planes.levels(), 3U);
    // The box of this lattice cuts kernels off, so only what is well inside of it is exact.
    FieldLattice whole = *plan_lattice(samples, Combination::kSum, {}, 1 << 20);
    const FieldPlanes all(samples, whole, combining_of(StatedField::kSum));
    EXPECT_GE(all.levels(), 2U);
    EXPECT_LE(largest_error(stated, kernel, StatedField::kSum, whole, evaluated(all, whole)), 3e-4)
        << static_cast<int>(kernel);
  }
}

TEST(FieldPlanesTest, AConstantIsConstantWhereThereAreSamples) {
  std::vector<StatedSample> stated = random_samples(300, 1, 0.3, 0.4, 3);
  for (StatedSample& sample : stated) sample.value = 0.7;
  const Samples samples = samples_of(stated, StatedKernel::kSpline, StatedField::kAverage);
  FieldLattice lattice{glm::dvec3(-0.8), 0.1, glm::u32vec3(17)};
  for (const float value : evaluated(FieldPlanes(samples, lattice, combining_of(StatedField::kAverage)), lattice)) {
    EXPECT_FLOAT_EQ(value, 0.7F);
  }
}

TEST(FieldPlanesTest, ADensityHasTheMassOfItsSamples) {
  const std::vector<StatedSample> stated = random_samples(50, 1, 0.1, 0.6, 4);
  double mass = 0;
  for (const StatedSample& sample : stated) mass += sample.value;
  for (const StatedKernel kernel : {StatedKernel::kSpline, StatedKernel::kCovariance}) {
    Samples samples = samples_of(stated, kernel, StatedField::kDensity);
    // Also where the lattice is far too coarse: kernels are widened and keep their integral.
    for (const uint32_t resolution : {220U, 16U}) {
      const FieldLattice lattice = *plan_lattice(samples, Combination::kSum, resolution, 0);
      Samples widened = samples;
      const uint64_t count = widen_to_lattice(lattice, true, widened);
      EXPECT_EQ(count > 0, resolution == 16U);
      double sum = 0;
      const FieldPlanes field(widened, lattice, combining_of(StatedField::kDensity));
      for (const float value : evaluated(field, lattice)) sum += static_cast<double>(value);
      EXPECT_NEAR(sum * std::pow(lattice.step, 3), mass, 5e-3 * mass) << resolution;
    }
  }
}

TEST(FieldPlanesTest, ValuesDoNotDependOnTheNumberOfThreads) {
  const std::vector<StatedSample> stated = random_samples(200, 1, 0.05, 0.8, 5);
  const Samples samples = samples_of(stated, StatedKernel::kCovariance, StatedField::kAverage);
  const FieldLattice lattice = *plan_lattice(samples, Combination::kSum, {}, 1 << 18);
  std::vector<std::vector<float>> found;
  for (const size_t threads : {1U, 3U}) {
    const oneapi::tbb::global_control limit(oneapi::tbb::global_control::max_allowed_parallelism, threads);
    found.push_back(evaluated(FieldPlanes(samples, lattice, combining_of(StatedField::kAverage)), lattice));
  }
  EXPECT_EQ(found[0], found[1]);
}

TEST(FieldLatticeTest, IsAsFineAsTheKernelsNeedWithinItsLimits) {
  const Samples samples = samples_of(random_samples(100, 1, 0.2, 0.2, 6), StatedKernel::kGaussian, StatedField::kSum);
  EXPECT_NEAR(plan_lattice(samples, Combination::kSum, {}, uint64_t{1} << 40)->step, 0.1, 1e-12);
  EXPECT_LE(plan_lattice(samples, Combination::kSum, {}, 1000)->samples(), 1000U);
  const FieldLattice lattice = *plan_lattice(samples, Combination::kSum, 77, 1000);
  EXPECT_EQ(std::max({lattice.size.x, lattice.size.y, lattice.size.z}), 77U);
}

TEST(FieldLatticeTest, PlacesBeyondThePrecisionOfTheirKernelsAreRefused) {
  Samples samples = samples_of(random_samples(10, 1, 0.2, 0.2, 7), StatedKernel::kGaussian, StatedField::kSum);
  for (KernelSample& sample : samples.kernels) sample.centre += glm::dvec3(1e16, 0, 0);
  EXPECT_FALSE(plan_lattice(samples, Combination::kSum, {}, 1000));
  for (KernelSample& sample : samples.kernels) sample.centre.x = 1e200;
  EXPECT_FALSE(plan_lattice(samples, Combination::kSum, {}, 1000));
}

}  // namespace
}  // namespace surfcast::scattered
