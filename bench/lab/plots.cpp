#include "lab/plots.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace surfcast::lab {
namespace {

constexpr int kColumns = 4;
constexpr double kPlotWidth = 250;   ///< of a plot with its margins
constexpr double kPlotHeight = 210;  ///< of a plot with its margins
constexpr double kLeft = 38;
constexpr double kRight = 12;
constexpr double kTop = 24;
constexpr double kBottom = 30;
constexpr double kLegend = 36;          ///< height of the legend above the plots
constexpr double kHighestPlotted = 60;  ///< dB; higher values are drawn there

constexpr std::array kColors{"#999999", "#6b4c9a", "#d2691e", "#c0392b", "#1b9e77",
                             "#1b6ca8", "#4a9bd1", "#7db8de", "#b3d7ef"};

std::string format(const char* pattern, auto... values) {
  char text[512];
  std::snprintf(text, sizeof text, pattern, values...);
  return text;
}

double plotted(const Measurement& m) {
  return std::min(m.errors.psnr, kHighestPlotted);
}

/// The plot of one scene, its corner at (x0, y0).
class ScenePlot {
 public:
  ScenePlot(const SceneResult& scene, double x0, double y0) : scene_(scene), x0_(x0), y0_(y0) {
    for (const Measurement& m : scene.measurements) {
      least_ms_ = std::min(least_ms_, m.milliseconds);
      most_ms_ = std::max(most_ms_, m.milliseconds);
      least_db_ = std::min(least_db_, plotted(m));
      most_db_ = std::max(most_db_, plotted(m));
    }
    least_ms_ /= 1.2;
    most_ms_ *= 1.2;
    least_db_ = 5 * std::floor((least_db_ - 0.5) / 5);
    most_db_ = 5 * std::ceil((most_db_ + 0.5) / 5);
  }

  [[nodiscard]] std::string svg() const { return frame() + frontier_line() + marks(); }

 private:
  [[nodiscard]] double x(double ms) const {
    return x0_ + kLeft + (kPlotWidth - kLeft - kRight) * std::log(ms / least_ms_) / std::log(most_ms_ / least_ms_);
  }
  [[nodiscard]] double y(double db) const {
    return y0_ + kPlotHeight - kBottom - (kPlotHeight - kTop - kBottom) * (db - least_db_) / (most_db_ - least_db_);
  }

  [[nodiscard]] std::string frame() const {
    std::string svg =
        format("<text x=\"%.1f\" y=\"%.1f\" font-weight=\"bold\">", x0_ + kLeft, y0_ + 16) + scene_.name + "</text>\n";
    for (double db = least_db_; db <= most_db_; db += most_db_ - least_db_ > 25 ? 10 : 5) {
      svg += format(
          "<path d=\"M%.1f %.1fH%.1f\" stroke=\"#ddd\"/><text x=\"%.1f\" y=\"%.1f\" text-anchor=\"end\">%g"
          "</text>\n",
          x0_ + kLeft, y(db), x0_ + kPlotWidth - kRight, x0_ + kLeft - 4, y(db) + 4, db);
    }
    for (double power = -1; power <= 4; ++power) {
      for (const double digit : {1.0, 2.0, 5.0}) {
        const double ms = digit * std::pow(10.0, power);
        if (ms < least_ms_ || ms > most_ms_) continue;
        svg += format(
            "<path d=\"M%.1f %.1fV%.1f\" stroke=\"#eee\"/><text x=\"%.1f\" y=\"%.1f\" text-anchor=\"middle\">"
            "%g</text>\n",
            x(ms), y(least_db_), y(most_db_), x(ms), y(least_db_) + 13, ms);
      }
    }
    return svg;
  }

  /// SVG path of the Pareto frontier, as steps.
  [[nodiscard]] std::string frontier_line() const {
    std::string path;
    for (const size_t i : frontier(scene_.measurements)) {
      const Measurement& m = scene_.measurements[i];
      path += path.empty() ? format("M%.1f %.1f", x(m.milliseconds), y(plotted(m)))
                           : format("H%.1fV%.1f", x(m.milliseconds), y(plotted(m)));
    }
    return "<path d=\"" + path + "\" fill=\"none\" stroke=\"#222\" stroke-dasharray=\"4 3\"/>\n";
  }

  [[nodiscard]] std::string marks() const {
    std::string svg;
    for (size_t i = 0; i < scene_.measurements.size(); ++i) {
      const Measurement& m = scene_.measurements[i];
      svg += format("<circle cx=\"%.1f\" cy=\"%.1f\" r=\"4.5\" fill=\"%s\"/>\n", x(m.milliseconds), y(plotted(m)),
                    kColors[i % kColors.size()]);
    }
    return svg;
  }

  const SceneResult& scene_;
  double x0_;
  double y0_;
  double least_ms_ = 1e9;
  double most_ms_ = 0;
  double least_db_ = kHighestPlotted;
  double most_db_ = 0;
};

std::string legend(const LabResults& results) {
  std::string svg;
  double x = 14;
  for (size_t i = 0; i < results.methods.size(); ++i) {
    svg += format("<circle cx=\"%.1f\" cy=\"14\" r=\"4.5\" fill=\"%s\"/><text x=\"%.1f\" y=\"18\">", x,
                  kColors[i % kColors.size()], x + 8) +
           results.methods[i].name + "</text>\n";
    x += 30 + 6.3 * static_cast<double>(results.methods[i].name.size());
  }
  return svg + format(
                   "<path d=\"M%.1f 14h24\" stroke=\"#222\" stroke-dasharray=\"4 3\"/><text x=\"%.1f\" y=\"18\">"
                   "frontier; across: ms, upwards: dB</text>\n",
                   x, x + 30);
}

}  // namespace

std::string svg_of(const LabResults& results) {
  const auto rows = static_cast<double>((results.scenes.size() + kColumns - 1) / kColumns);
  const double width = kColumns * kPlotWidth;
  const double height = kLegend + rows * kPlotHeight;
  std::string svg = format(
                        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 %g %g\" font-family=\"sans-serif\" "
                        "font-size=\"11\">\n<rect width=\"%g\" height=\"%g\" fill=\"white\"/>\n",
                        width, height, width, height) +
                    legend(results);
  for (size_t i = 0; i < results.scenes.size(); ++i) {
    const auto column = static_cast<double>(i % kColumns);
    const auto line = static_cast<double>(i / kColumns);
    svg += ScenePlot(results.scenes[i], column * kPlotWidth, kLegend + line * kPlotHeight).svg();
  }
  return svg + "</svg>\n";
}

}  // namespace surfcast::lab
