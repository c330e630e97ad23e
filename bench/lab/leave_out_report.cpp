#include "lab/leave_out_report.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "lab/markdown_table.h"

namespace surfcast::lab {
namespace {

using nlohmann::ordered_json;

double four_digits(double value) {
  return std::round(value * 1e4) / 1e4;
}

ordered_json four_digits(const std::vector<double>& values) {
  ordered_json list = ordered_json::array();
  for (const double value : values) list.push_back(four_digits(value));
  return list;
}

ordered_json json_of(const glm::dvec3& v) {
  return {v.x, v.y, v.z};
}

ordered_json json_of(const CameraResult& camera) {
  const geometry::Camera& view = camera.camera.camera;
  return {{"camera", camera.camera.name},
          {"position", json_of(view.position)},
          {"focal_point", json_of(view.focal_point)},
          {"view_up", json_of(view.view_up)},
          {"view_angle", view.view_angle},
          {"open", camera.counts.open()},
          {"hidden", camera.counts.by_verdict[static_cast<size_t>(Verdict::kHidden)]},
          {"missing", camera.counts.by_verdict[static_cast<size_t>(Verdict::kMissing)]}};
}

ordered_json json_of(const LeaveOutFigures& f, const LeaveOutResult& result) {
  ordered_json cameras = ordered_json::array();
  for (const CameraResult& camera : result.cameras) cameras.push_back(json_of(camera));
  return {{"scan", f.scan},
          {"points", f.points},
          {"off_surface", four_digits(f.off_surface)},
          {"hidden", four_digits(f.hidden)},
          {"missing", four_digits(f.missing)},
          {"surface_hidden", four_digits(f.surface_hidden)},
          {"largest_radius", four_digits(f.largest_radius)},
          {"colors", four_digits(f.colors)},
          {"near_colors", four_digits(f.near_colors)},
          {"cameras", cameras}};
}

LeaveOutFigures figures_of(const ordered_json& json) {
  return {json.at("scan"),           json.at("points"),  json.at("off_surface"),
          json.at("hidden"),         json.at("missing"), json.at("surface_hidden"),
          json.at("largest_radius"), json.at("colors"),  json.at("near_colors")};
}

/// The figures that change with the model.
std::vector<std::string> changing_cells(const LeaveOutFigures* f, const std::vector<double>& sigmas) {
  std::vector<std::string> cells(3 + sigmas.size());
  if (f == nullptr) return cells;
  cells[0] = number(f->hidden, 2) + " + " + number(f->missing, 2);
  cells[1] = number(f->surface_hidden, 2);
  cells[2] = number(f->largest_radius, 1);
  for (size_t k = 0; k < std::min(f->colors.size(), sigmas.size()); ++k) cells[3 + k] = number(f->colors[k], 2);
  return cells;
}

std::vector<std::string> changing_titles(const std::string& when, const std::vector<double>& sigmas) {
  std::vector<std::string> titles{when + "hidden + missing", when + "surface hidden", when + "widest"};
  for (const double sigma : sigmas) {
    titles.push_back(when + "colour" + (sigmas.size() > 1 ? ", " + number(sigma, 2) + " r" : ""));
  }
  return titles;
}

void join(std::vector<std::string>& cells, const std::vector<std::string>& more) {
  cells.insert(cells.end(), more.begin(), more.end());
}

const LeaveOutFigures* find(const LeaveOutReport& report, const std::string& scan) {
  const auto found = std::ranges::find(report.scans, scan, &LeaveOutFigures::scan);
  return found == report.scans.end() ? nullptr : &*found;
}

std::string header_of(const LeaveOutReport& report, const std::optional<LeaveOutReport>& before) {
  std::vector<std::string> titles{"scan", "points", "off surface"};
  if (before) join(titles, changing_titles("before: ", before->sigmas));
  join(titles, changing_titles(before ? "now: " : "", report.sigmas));
  return header(titles);
}

}  // namespace

LeaveOutFigures figures_of(const LeaveOutResult& result) {
  const LeaveOutCounts total = result.total();
  LeaveOutFigures f{result.name,
                    result.points,
                    total.off_surface_percent(),
                    total.percent(Verdict::kHidden),
                    total.percent(Verdict::kMissing),
                    total.surface_hidden_percent(),
                    result.largest_radius,
                    {},
                    {}};
  for (const KernelColors& kernel : result.colors()) {
    f.colors.push_back(kernel.all.rms().value_or(0));
    f.near_colors.push_back(kernel.near.rms().value_or(0));
  }
  return f;
}

std::string json_of(const LeaveOutReport& report, const std::vector<LeaveOutResult>& results) {
  ordered_json scans = ordered_json::array();
  for (size_t i = 0; i < results.size(); ++i) scans.push_back(json_of(report.scans[i], results[i]));
  return ordered_json{{"sigmas", four_digits(report.sigmas)}, {"scans", scans}}.dump(1) + "\n";
}

std::optional<LeaveOutReport> report_of(const std::string& json) {
  try {
    const ordered_json parsed = ordered_json::parse(json);
    LeaveOutReport report{parsed.at("sigmas"), {}};
    for (const ordered_json& scan : parsed.at("scans")) report.scans.push_back(figures_of(scan));
    return report;
  } catch (const nlohmann::json::exception&) {
    return std::nullopt;
  }
}

std::string markdown_of(const LeaveOutReport& report, const std::optional<LeaveOutReport>& before) {
  std::string text = header_of(report, before);
  for (const LeaveOutFigures& f : report.scans) {
    std::vector<std::string> cells{f.scan, std::to_string(f.points), number(f.off_surface, 1)};
    if (before) join(cells, changing_cells(find(*before, f.scan), before->sigmas));
    join(cells, changing_cells(&f, report.sigmas));
    text += row(cells);
  }
  return text + "\n";
}

}  // namespace surfcast::lab
