#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lab/leave_out_study.h"

namespace surfcast::lab {

/// The lines in kResultsPage (lab/report.h) that enclose the results.
inline constexpr const char* kLeaveOutBegin = "<!-- leave_out: begin -->";
inline constexpr const char* kLeaveOutEnd = "<!-- leave_out: end -->";

/// The figures of one scan as they are reported.
struct LeaveOutFigures {
  std::string scan;
  uint64_t points = 0;
  double off_surface = 0;           ///< percent of the open points
  double hidden = 0;                ///< likewise
  double missing = 0;               ///< likewise
  double surface_hidden = 0;        ///< percent of the open points on a surface
  double largest_radius = 0;        ///< spacings of the surfaces around
  std::vector<double> colors;       ///< rms levels of 255, for each kernel; empty without colours
  std::vector<double> near_colors;  ///< likewise, of the points whose neighbours are two pixels and more away
};

struct LeaveOutReport {
  std::vector<double> sigmas;  ///< of the kernels, in radii
  std::vector<LeaveOutFigures> scans;
};

LeaveOutFigures figures_of(const LeaveOutResult& result);

/// The report as JSON, with the counts of each camera.
std::string json_of(const LeaveOutReport& report, const std::vector<LeaveOutResult>& results);
/// Reads the figures back from such JSON. None if it is not of this form.
std::optional<LeaveOutReport> report_of(const std::string& json);

/// A table with a row for each scan. With an earlier report, its figures stand before those of this one.
std::string markdown_of(const LeaveOutReport& report, const std::optional<LeaveOutReport>& before);

}  // namespace surfcast::lab
