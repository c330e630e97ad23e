#include "net/metrics.h"

#include <sstream>
#include <string_view>

namespace surfcast::net {
namespace {

void write_value(std::ostream& out, std::string_view name, std::string_view type, std::string_view help,
                 uint64_t value) {
  out << "# HELP " << name << ' ' << help << "\n# TYPE " << name << ' ' << type << '\n' << name << ' ' << value << '\n';
}

/// A label's value with the three characters escaped that the format wants escaped.
std::string escape_label(std::string_view text) {
  std::string escaped;
  for (const char c : text) {
    if (c == '\\' || c == '"') escaped += '\\';
    escaped += c == '\n' ? ' ' : c;
  }
  return escaped;
}

}  // namespace

void Metrics::count_picture(size_t bytes, const picture::FrameStats& stats) {
  ++pictures;
  picture_bytes += bytes;
  count_stages(stats);
}

void Metrics::count_stages(const picture::FrameStats& stats) {
  surfels_drawn += stats.surfels_drawn;
  for (const picture::StageTime& stage : stats.stages) stage_seconds[stage.name] += stage.milliseconds / 1e3;
}

std::string to_prometheus(const Metrics& m, const Gauges& gauges) {
  std::ostringstream out;
  write_value(out, "surfcast_connections_total", "counter", "Connections accepted.", m.connections);
  write_value(out, "surfcast_connections_open", "gauge", "Connections open now.", gauges.connections);
  write_value(out, "surfcast_connections_refused_total", "counter", "Connections refused, too many at once.",
              m.connections_refused);
  write_value(out, "surfcast_requests_total", "counter", "Requests read.", m.requests);
  write_value(out, "surfcast_errors_total", "counter", "Requests answered with an error.", m.errors);
  write_value(out, "surfcast_pictures_total", "counter", "Pictures drawn and delivered.", m.pictures);
  write_value(out, "surfcast_picture_bytes_total", "counter", "Encoded bytes of pictures.", m.picture_bytes);
  write_value(out, "surfcast_surfels_drawn_total", "counter", "Surfels drawn.", m.surfels_drawn);
  write_value(out, "surfcast_views_open", "gauge", "Views open now.", m.views.open);
  write_value(out, "surfcast_view_frames_total", "counter", "Frames of views sent.", m.views.frames);
  write_value(out, "surfcast_view_frames_dropped_total", "counter",
              "Frames of views given up while they were drawn, encoded or sent.", m.views.dropped);
  write_value(out, "surfcast_view_updates_replaced_total", "counter",
              "Updates of views overtaken by a newer one before they were drawn.", m.views.replaced);
  write_value(out, "surfcast_view_bytes_total", "counter", "Encoded bytes of frames of views.", m.views.bytes);
  write_value(out, "surfcast_queued_pictures", "gauge", "Pictures that wait for the render thread.", gauges.queued);
  write_value(out, "surfcast_gpu_memory_budget_bytes", "gauge", "Most memory for surfels on the GPU.",
              gauges.memory.gpu);
  write_value(out, "surfcast_host_memory_budget_bytes", "gauge", "Most host memory for decoded blocks.",
              gauges.memory.host);
  out << "# HELP surfcast_stage_seconds_total Time spent on pictures, by stage.\n"
         "# TYPE surfcast_stage_seconds_total counter\n";
  for (const auto& [stage, seconds] : m.stage_seconds) {
    out << "surfcast_stage_seconds_total{stage=\"" << escape_label(stage) << "\"} " << seconds << '\n';
  }
  return out.str();
}

}  // namespace surfcast::net
