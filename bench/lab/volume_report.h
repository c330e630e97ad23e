#pragma once

#include <string>
#include <vector>

#include "lab/results.h"

namespace surfcast::lab {

/// The lines of laboratory.md that enclose the results of volumes and Gaussian models.
inline constexpr const char* kVolumesBegin = "<!-- volumes: begin -->";
inline constexpr const char* kVolumesEnd = "<!-- volumes: end -->";

/// A volume of a file: time at rest, and error against 16 samples a spacing.
struct FileResult {
  std::string name;
  std::string about;
  int side = 0;  ///< pixels
  double milliseconds = 0;
  double processor_milliseconds = 0;
  double psnr = 0;  ///< dB
};

/// Errors are over the pixels that either picture covers. Times are processor times.
struct VolumeResults {
  LabResults volumes;
  LabResults gaussians;
  std::vector<FileResult> files;
};

std::string markdown_of(const VolumeResults& results);
std::string json_of(const VolumeResults& results);
/// The plot of either part, over the processor time.
std::string svg_over_processor_time(LabResults results);

}  // namespace surfcast::lab
