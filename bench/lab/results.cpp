#include "lab/results.h"

#include <algorithm>
#include <numeric>

namespace surfcast::lab {

const Measurement* find(const SceneResult& scene, const std::string& method) {
  const auto found = std::ranges::find_if(scene.measurements, [&](const Measurement& m) { return m.method == method; });
  return found == scene.measurements.end() ? nullptr : &*found;
}

const SceneResult* find(const LabResults& results, const std::string& scene) {
  const auto found = std::ranges::find_if(results.scenes, [&](const SceneResult& s) { return s.name == scene; });
  return found == results.scenes.end() ? nullptr : &*found;
}

std::vector<size_t> frontier(const std::vector<Measurement>& measurements) {
  std::vector<size_t> order(measurements.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::ranges::sort(order, [&](size_t a, size_t b) {
    const Measurement& x = measurements[a];
    const Measurement& y = measurements[b];
    return x.milliseconds != y.milliseconds ? x.milliseconds < y.milliseconds : x.errors.psnr > y.errors.psnr;
  });
  std::vector<size_t> best;
  for (const size_t i : order) {
    if (best.empty() || measurements[i].errors.psnr > measurements[best.back()].errors.psnr) best.push_back(i);
  }
  return best;
}

}  // namespace surfcast::lab
