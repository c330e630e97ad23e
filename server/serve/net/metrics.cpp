#include "net/metrics.h"

namespace surfcast::net {
namespace {

/// Of a server without TLS: nothing.
void write_tls(Exposition& out, const Metrics& m) {
  if (m.tls_expires == 0) return;
  out.value("surfcast_tls_handshakes_failed_total", "counter", "Handshakes of TLS that failed.", m.tls_failures);
  out.value("surfcast_tls_reloads_failed_total", "counter",
            "New certificates that could not be used, so that the former ones stay.", m.tls_reloads_failed);
  out.value("surfcast_tls_certificate_expires_seconds", "gauge", "End of the certificate, since 1970.",
            static_cast<uint64_t>(m.tls_expires));
}

void write_workers(Exposition& out, const WorkerGauges& workers) {
  const auto& [render, queries] = workers;
  out.value("surfcast_workers_started_total", "counter", "Render workers started.", render.started);
  out.value("surfcast_workers_ended_total", "counter", "Render workers that crashed, were killed or hung.",
            render.ended);
  out.value("surfcast_blocks_quarantined_total", "counter",
            "Blocks that are not loaded any more, because they have ended two render workers.", render.quarantined);
  out.value("surfcast_query_workers_started_total", "counter", "Query workers started.", queries.started);
  out.value("surfcast_query_workers_ended_total", "counter", "Query workers that crashed, were killed or hung.",
            queries.ended);
  out.value("surfcast_query_blocks_quarantined_total", "counter",
            "Blocks that are not read for queries any more, because they have ended two query workers.",
            queries.quarantined);
}

}  // namespace

void Metrics::count_picture(size_t bytes, const picture::FrameStats& stats) {
  ++pictures;
  picture_bytes += bytes;
  count_stages(stats, still);
}

void Metrics::count_stages(const picture::FrameStats& stats, PictureTimes& times) {
  surfels_drawn += stats.surfels_drawn;
  double whole = 0;
  for (const picture::StageTime& stage : stats.stages) {
    const double seconds = stage.milliseconds / 1e3;
    stage_seconds[stage.name] += seconds;
    if (stage.name == "queue") times.queue.add(seconds);
    whole += seconds;
  }
  times.whole.add(whole);
}

std::string metrics_text(const Metrics& m, const Gauges& gauges, Exposition::Format format) {
  Exposition out(format);
  out.value("surfcast_connections_total", "counter", "Connections accepted.", m.connections);
  out.value("surfcast_connections_open", "gauge", "Connections open now.", gauges.connections);
  out.value("surfcast_connections_refused_total", "counter", "Connections refused, too many at once.",
            m.connections_refused);
  out.value("surfcast_connections_given_way_total", "counter", "Idle connections closed in favour of new ones.",
            m.connections_given_way);
  write_tls(out, m);
  out.value("surfcast_guests_open", "gauge", "Connections open now that have named a token.", gauges.users);
  out.value("surfcast_denied_total", "counter", "Tokens that are not known, or have ended.", gauges.denied);
  out.value("surfcast_audit_lost_total", "counter", "Events that the audit log could not be told.", gauges.audit_lost);
  out.value("surfcast_audit_left_out_total", "counter", "Denials without a line of the audit log, beyond its limit.",
            gauges.audit_left_out);
  out.value("surfcast_requests_total", "counter", "Requests read.", m.requests);
  out.value("surfcast_errors_total", "counter", "Requests answered with an error.", m.errors);
  out.value("surfcast_pictures_total", "counter", "Pictures drawn and delivered.", m.pictures);
  out.value("surfcast_picture_bytes_total", "counter", "Encoded bytes of pictures.", m.picture_bytes);
  out.value("surfcast_surfels_drawn_total", "counter", "Surfels drawn.", m.surfels_drawn);
  out.value("surfcast_views_open", "gauge", "Views open now.", m.views.open);
  out.value("surfcast_sessions_waiting", "gauge", "Sessions without a connection whose clients may come back.",
            gauges.waiting);
  out.value("surfcast_view_frames_total", "counter", "Frames of views sent.", m.views.frames);
  out.value("surfcast_view_frames_dropped_total", "counter",
            "Frames of views given up while they were drawn, encoded or sent.", m.views.dropped);
  out.value("surfcast_view_updates_replaced_total", "counter",
            "Updates of views overtaken by a newer one before they were drawn.", m.views.replaced);
  out.value("surfcast_view_bytes_total", "counter", "Encoded bytes of frames of views.", m.views.bytes);
  out.value("surfcast_queued_pictures", "gauge", "Pictures that wait for the render thread.", gauges.queued);
  out.value("surfcast_picture_memory_bytes", "gauge",
            "Memory of pictures at rest that are drawn, encoded or not taken by their clients.", gauges.picture_memory);
  out.value("surfcast_gpu_memory_budget_bytes", "gauge", "Most memory for surfels on the GPU.", gauges.memory.gpu);
  out.value("surfcast_host_memory_budget_bytes", "gauge", "Most host memory for decoded blocks.", gauges.memory.host);
  if (gauges.workers) write_workers(out, *gauges.workers);
  out.begin("surfcast_stage_seconds_total", "counter", "Time spent on pictures, by stage.");
  for (const auto& [stage, seconds] : m.stage_seconds) {
    out.add("surfcast_stage_seconds_total", label_of("stage", stage), seconds);
  }
  out.begin("surfcast_picture_seconds", "histogram", "Time of a picture from its order to its bytes, by kind.");
  out.add("surfcast_picture_seconds", label_of("kind", "still"), m.still.whole);
  out.add("surfcast_picture_seconds", label_of("kind", "view"), m.view.whole);
  out.begin("surfcast_queue_seconds", "histogram", "Wait of a picture for the render thread, by kind.");
  out.add("surfcast_queue_seconds", label_of("kind", "still"), m.still.queue);
  out.add("surfcast_queue_seconds", label_of("kind", "view"), m.view.queue);
  return out.text();
}

}  // namespace surfcast::net
