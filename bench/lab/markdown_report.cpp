#include <algorithm>
#include <functional>

#include "lab/markdown_table.h"
#include "lab/report.h"

namespace surfcast::lab {
namespace {

using Cell = std::function<std::string(const SceneResult&, const Measurement&)>;

/// A table with a row for each scene and a column for each method.
std::string matrix(const LabResults& results, const Cell& cell) {
  std::vector<std::string> names{"scene"};
  for (const MethodFacts& method : results.methods) names.push_back(method.name);
  std::string text = header(names);
  for (const SceneResult& scene : results.scenes) {
    std::vector<std::string> cells{scene.name};
    for (const Measurement& m : scene.measurements) cells.push_back(cell(scene, m));
    text += row(cells);
  }
  return text + "\n";
}

/// Time and PSNR of a measurement; the highest PSNR of a scene is bold.
std::string time_and_error(const SceneResult& scene, const Measurement& m) {
  double best = 0;
  for (const Measurement& other : scene.measurements) best = std::max(best, other.errors.psnr);
  const std::string error = number(m.errors.psnr, 1) + " dB";
  return number(m.milliseconds, 1) + " ms, " + (m.errors.psnr == best ? "**" + error + "**" : error);
}

std::string methods_and_scenes(const LabResults& results) {
  std::string text = header({"method", ""});
  for (const MethodFacts& method : results.methods) text += row({method.name, method.about});
  text += "\n" + header({"scene", "", "surfels"});
  for (const SceneResult& scene : results.scenes) {
    text += row({scene.name, scene.about, std::to_string(scene.surfels)});
  }
  return text + "\n";
}

/// The plain method with the highest PSNR.
const Measurement* best_plain(const LabResults& results, const SceneResult& scene) {
  const Measurement* best = nullptr;
  for (const MethodFacts& method : results.methods) {
    const Measurement* m = method.plain ? find(scene, method.name) : nullptr;
    if (m != nullptr && (best == nullptr || m->errors.psnr > best->errors.psnr)) best = m;
  }
  return best;
}

/// Difference of the PSNR of two methods.
std::string ahead(const Measurement& ours, const Measurement& other) {
  return number(ours.errors.psnr - other.errors.psnr, 1) + " dB";
}

/// Ratio of the times of two methods. Processor time is used, because it is less sensitive to other load.
std::string times(const Measurement& ours, const Measurement& other) {
  return number(ours.processor_milliseconds / other.processor_milliseconds, 2);
}

std::string gains(const LabResults& results) {
  std::string text = header({"scene", "best plain method", "per pixel is ahead by", "at rest by", "papers' kernel",
                             "per pixel is ahead by", "at rest by", "per pixel takes", "at rest"});
  for (const SceneResult& scene : results.scenes) {
    const Measurement* moving = find(scene, "per pixel");
    const Measurement* rest = find(scene, "at rest");
    const Measurement* papers = find(scene, "papers' kernel");
    const Measurement* plain = best_plain(results, scene);
    if (moving == nullptr || rest == nullptr || papers == nullptr || plain == nullptr) continue;
    text += row({scene.name, plain->method + ", " + number(plain->errors.psnr, 1) + " dB", ahead(*moving, *plain),
                 ahead(*rest, *plain), number(papers->errors.psnr, 1) + " dB", ahead(*moving, *papers),
                 ahead(*rest, *papers), times(*moving, *papers), times(*rest, *papers)});
  }
  return text + "\n";
}

/// A row of table 1 of Ren 2002: frames per second on two graphics cards.
struct RenRow {
  const char* algorithm;
  double radeon;
  double geforce;
  const char* method;
};
constexpr RenRow kRenTable[] = {{"without EWA", 57.3, 59.6, "no prefilter"},
                                {"EWA, per-pixel normalisation", 1.3, 1.0, "per pixel"},
                                {"EWA, per-surfel normalisation", 16.9, 23.8, "per surfel"}};

std::string ren_table(const LabResults& results) {
  const SceneResult* scene = find(results, "checker_oblique");
  const Measurement* base = scene != nullptr ? find(*scene, kRenTable[0].method) : nullptr;
  if (base == nullptr) return "";
  std::string text = header({"64k surfels, 512 x 512", "Ren: frames/s, Radeon 8500, GeForce4",
                             "Ren: times the first row", "ours, ms", "ours: times the first row", "PSNR"});
  for (const RenRow& r : kRenTable) {
    const Measurement* m = find(*scene, r.method);
    text += row({r.algorithm, number(r.radeon, 1) + ", " + number(r.geforce, 1),
                 number(kRenTable[0].radeon / r.radeon, 1) + ", " + number(kRenTable[0].geforce / r.geforce, 1),
                 number(m->milliseconds, 1), number(m->milliseconds / base->milliseconds, 2),
                 number(m->errors.psnr, 1) + " dB"});
  }
  return text + "\n";
}

std::string stages(const LabResults& results) {
  constexpr const char* kStages[] = {"project", "bin", "splat", "read"};
  std::string text = header({"per pixel, ms", "splats", "project", "bin", "splat", "read", "million surfels/s"});
  for (const SceneResult& scene : results.scenes) {
    const Measurement* m = find(scene, "per pixel");
    if (m == nullptr) continue;
    std::vector<std::string> cells{scene.name, std::to_string(m->splats)};
    for (const char* name : kStages) {
      for (const picture::StageTime& stage : m->stages) {
        if (stage.name == name) cells.push_back(number(stage.milliseconds, 1));
      }
    }
    cells.push_back(number(m->surfels_per_second * 1e-6, 2));
    text += row(cells);
  }
  return text + "\n";
}

/// Scans judged by points that were left out; the least colour error of a scan is bold.
std::string left_out(const LabResults& results) {
  std::vector<std::string> names{"scan", "hidden + missing, %"};
  for (const MethodFacts& method : results.methods) names.push_back(method.name);
  std::string rows;
  for (const SceneResult& scene : results.scenes) {
    if (!scene.left_out || scene.left_out->colors.empty()) continue;
    const LeaveOutFigures& f = *scene.left_out;
    const double least = *std::ranges::min_element(f.colors);
    std::vector<std::string> cells{scene.name, number(f.hidden, 1) + " + " + number(f.missing, 1)};
    for (const double error : f.colors) {
      cells.push_back(error == least ? "**" + number(error, 2) + "**" : number(error, 2));
    }
    rows += row(cells);
  }
  if (rows.empty()) return "";
  return "Points left out (see below): how many of them per-pixel EWA hides or misses, and the rms colour error of the "
         "others,\nin levels of 255; bold is the least. This error needs no ideal picture:\n\n" +
         header(names) + rows + "\n";
}

size_t occurrences(const std::string& text, const std::string& line) {
  size_t count = 0;
  for (size_t at = text.find(line); at != std::string::npos; at = text.find(line, at + line.size())) ++count;
  return count;
}

}  // namespace

std::string markdown_of(const LabResults& results) {
  return "Device: " + results.device + "; 512 x 512; milliseconds are medians of " + std::to_string(results.frames) +
         " frames.\nThe methods took turns.\n\n" + methods_and_scenes(results) +
         "Time of a frame, and PSNR against the ideal picture; bold is the least error of a scene:\n\n" +
         matrix(results, time_and_error) + "![Time against error](images/laboratory.svg)\n\n" + left_out(results) +
         "Structural similarity, and PSNR of the worst tile of 32 x 32 pixels:\n\n" +
         matrix(results,
                [](const auto&, const Measurement& m) {
                  return number(m.errors.ssim, 4) + ", " + number(m.errors.worst_tile, 1) + " dB";
                }) +
         "Flicker: the root mean square change of the error, in levels of 255, from frame to frame of a path that "
         "moves by\n"
         "0.4 pixels a frame (256 x 256):\n\n" +
         matrix(results, [](const auto&, const Measurement& m) { return number(m.flicker, 2); }) +
         "What per-pixel EWA gains over the best plain method, and over the papers' kernel; processor time as a "
         "multiple of\n"
         "that of the papers' kernel:\n\n" +
         gains(results) + "Ren's table 1 and figure 11:\n\n" + ren_table(results) + "Where the time goes:\n\n" +
         stages(results);
}

Result<std::string> with_section(const std::string& text, const std::string& begin, const std::string& end,
                                 const std::string& section) {
  if (occurrences(text, begin) != 1 || occurrences(text, end) != 1 || text.find(begin) > text.find(end)) {
    return fail(ErrorKind::kInvalidInput, "no section between " + begin + " and " + end);
  }
  return text.substr(0, text.find(begin) + begin.size()) + "\n\n" + section + text.substr(text.find(end));
}

}  // namespace surfcast::lab
