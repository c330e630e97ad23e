#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "lab/errors.h"
#include "lab/leave_out_report.h"
#include "picture/picture.h"

namespace surfcast::lab {

/// Description of a method, for tables and plots.
struct MethodFacts {
  std::string name;
  std::string about;
  bool plain = false;  ///< one of the plain methods with which splats are compared
};

/// The results of one method for one scene.
struct Measurement {
  std::string method;
  double milliseconds = 0;  ///< median of a frame, from the request to its pixels in memory
  double processor_milliseconds =
      0;  ///< the same in processor time: the cost on software GL, almost independent of other load
  std::vector<picture::StageTime> stages;  ///< medians
  double surfels_per_second = 0;           ///< of the scan, also if a coarser level is drawn instead of them
  uint64_t splats = 0;                     ///< drawn splats, after culling
  PictureErrors errors;
  double flicker = 0;  ///< levels of 255
};

struct SceneResult {
  std::string name;
  std::string about;
  uint64_t surfels = 0;
  std::vector<Measurement> measurements;      ///< in the order of the methods
  std::optional<LeaveOutFigures> left_out{};  ///< colours in the order of the methods
};

struct LabResults {
  std::string device;
  int frames = 0;  ///< number of frames of each median
  std::vector<MethodFacts> methods;
  std::vector<SceneResult> scenes;
};

/// Null if the scene was not measured with the method.
const Measurement* find(const SceneResult& scene, const std::string& method);
const SceneResult* find(const LabResults& results, const std::string& scene);

/// The Pareto frontier: indices of the measurements for which no other one is better in both time and PSNR, fastest
/// first.
std::vector<size_t> frontier(const std::vector<Measurement>& measurements);

}  // namespace surfcast::lab
