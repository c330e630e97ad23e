#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "lab/errors.h"
#include "picture/picture.h"

namespace surfcast::lab {

/// What a method is, for tables and plots.
struct MethodFacts {
  std::string name;
  std::string about;
  bool plain = false;  ///< one of those that splats are measured against
};

/// A scene under a method.
struct Measurement {
  std::string method;
  double milliseconds = 0;  ///< median of a frame, from the request to its pixels in memory
  double processor_milliseconds =
      0;  ///< the same in processor time: the cost on software GL, which other load hardly changes
  std::vector<picture::StageTime> stages;  ///< medians
  double surfels_per_second = 0;           ///< of the scan, whether or not a coarser level stands for them
  uint64_t splats = 0;                     ///< drawn, once what faces away or lies outside has been left out
  PictureErrors errors;
  double flicker = 0;  ///< levels of 255
};

struct SceneResult {
  std::string name;
  std::string about;
  uint64_t surfels = 0;
  std::vector<Measurement> measurements;  ///< in the order of the methods
};

struct LabResults {
  std::string device;
  int frames = 0;  ///< that each time is the median of
  std::vector<MethodFacts> methods;
  std::vector<SceneResult> scenes;
};

/// Null where the scene was not measured under the method.
const Measurement* find(const SceneResult& scene, const std::string& method);
const SceneResult* find(const LabResults& results, const std::string& scene);

/// Indices of the measurements that no other one beats in both time and PSNR, fastest first.
std::vector<size_t> frontier(const std::vector<Measurement>& measurements);

}  // namespace surfcast::lab
