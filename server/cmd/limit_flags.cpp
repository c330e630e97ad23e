#include "cmd/limit_flags.h"

#include "cmd/input_flags.h"
#include "cmd/settings.h"
#include "protocol/request_flags.h"

namespace surfcast::cmd {
namespace {

constexpr uint64_t kMebibyte = uint64_t{1} << 20;
constexpr SettingRange kThreads{1, 1024};
constexpr SettingRange kOrNone{0, 1'000'000};

void add_queue_flags(CLI::App& command, service::ServiceLimits& limits) {
  add_count(command, "max-queue", limits.queued_jobs,
            "Pictures that may wait for the renderer (default 256). More: longer waits; less: refused sooner");
  add_seconds(command, "queue-timeout", limits.queue_timeout,
              "Wait of a picture for the renderer before it is refused (default 20). More: pictures that nobody waits "
              "for any longer are drawn; less: refused under short peaks");
  add_count(command, "encoders", limits.encoders,
            "Threads that encode pictures at rest (default 2). More: processor time taken from software rendering; "
            "less: finished pictures wait",
            kThreads);
  add_count(command, "max-frames", limits.frames_in_encoding,
            "Drawn pictures in memory that wait for an encoder (default 3). More: memory, 4 to 16 bytes a pixel; less: "
            "the renderer waits");
  add_size(
      command, "picture-memory", limits.picture_memory,
      "Pictures at rest from drawing until their clients have taken them (default: a quarter of the host's available "
      "memory, 1G at most; half of it for one client). More: memory; less: large pictures wait for each other");
}

void add_pick_flags(CLI::App& command, service::PickLimits& limits) {
  add_pick_cache_flag(command, limits);
  add_count(command, "pick-threads", limits.threads,
            "Threads that find what a pixel shows, each with a process (default 2). More: memory and processor time; "
            "less: picks wait",
            kThreads);
  add_count(command, "max-picks", limits.waiting,
            "Picks, and profiles, that may be outstanding (default 64 each). More: longer waits; less: refused sooner");
  add_count(
      command, "max-pick-blocks", limits.blocks,
      "Blocks of a model that one pick may read (default 256). More: wide pixels occupy a thread for longer; less: "
      "picks in small pictures of large models are refused");
  add_count(command, "max-profile-points", limits.profile_points,
            "Points of one profile (default 1000000). More: memory, some 250 bytes a point and 50 for each attribute; "
            "less: coarser samples of wide profiles",
            {1, 100'000'000});
  add_count(command, "max-region-points", limits.region_points,
            "Points of one region that are handed out (default 100000000). More: one client occupies disk and line for "
            "long; less: large regions are refused",
            {1, UINT64_MAX});
  add_count(command, "max-regions", limits.regions,
            "Regions whose points are on their way at a time (default 16). More: memory, some MiB for each; less: "
            "refused sooner");
  add_size(command, "region-piece", limits.region_bytes,
           "Piece in which the file of a region is made (default 1M). More: memory of every region; less: more turns",
           {65536, 256 * kMebibyte});
}

void add_connection_flags(CLI::App& command, net::ServerConfig& server) {
  add_count(command, "max-connections", server.clients.connections,
            "Connections at once (default 256). More: memory and descriptors; less: refused sooner", {1, 1'000'000},
            "connections");
  add_count(command, "max-connections-per-client", server.clients.connections_per_client,
            "Connections of one address (default 64; 0: no limit of its own). More: one client may take all; less: "
            "clients behind one proxy are refused",
            kOrNone);
  add_count(command, "max-views", server.views,
            "Views open on one connection (default 8). More: one client loads the renderer; less: pages with many "
            "views are refused");
  add_count(command, "max-views-per-client", server.clients.views_per_client,
            "Views of one address (default 0: no limit of its own). More and less as for connections", kOrNone);
  add_size(command, "view-memory", server.kept_frame_bytes,
           "Pixels of a view at rest that are kept to encode them again (default 32M). More: memory of every view; "
           "less: the last picture at rest of large views is drawn twice");
}

void add_request_flags(CLI::App& command, net::ServerConfig& server) {
  add_count(command, "max-requests", server.requests.outstanding,
            "Requests of one connection without an answer (default 64). More: memory; less: pipelines are refused");
  add_count(command, "max-drawing", server.requests.drawing,
            "Pictures of one connection with the renderer (default 2). More: one client fills the queue; less: the "
            "renderer waits between two");
  add_size_setter(
      command, "send-buffer",
      [&server](uint64_t bytes) {
        server.requests.outgoing_bytes = bytes;
        server.unread_bytes = 2 * bytes;
      },
      "Answers that a client has not taken before nothing more is drawn for it; twice that, and nothing more is read "
      "from it (default 32M). More: memory of slow clients; less: they wait");
  add_size(command, "max-unread", server.small_unread_bytes,
           "Answers of at most 64K that a client has not taken before nothing more is read from it (default 1M). More: "
           "memory of clients that do not read; less: clients that ask much and read late wait");
  add_size(
      command, "least-rate", server.least_rate,
      "Bytes of its answers that a client takes each second, over --answer-timeout (default 8K; 0: any). More: slow "
      "networks are cut off; less: clients that hardly read hold memory",
      {0, 1 << 30});
  add_size(command, "max-message", server.request_bytes,
           "A message of a client (default 64K). More: memory of hostile clients; less: requests with many clip boxes "
           "are refused",
           {1024, 64 * kMebibyte});
  add_size(command, "max-http-header", server.http_header_bytes,
           "The header of an HTTP request, with its query (default 16K). More: memory of every connection; less: long "
           "queries and cookies are refused",
           {1024, kMebibyte});
}

void add_time_flags(CLI::App& command, net::ServerConfig& server) {
  add_count(command, "log-lines", server.log_lines,
            "Lines of the log a minute of each kind that clients cause (default 60; 0: all). More: clients fill the "
            "disk; less: of many that are refused, few are named",
            kOrNone);
  add_seconds(command, "handshake-timeout", server.hello,
              "For the first words of a connection, and for every request that has begun (default 10). More: silent "
              "connections stay; less: slow networks are cut off");
  add_seconds(
      command, "give-way-after", server.give_way,
      "Idle time after which a connection may be closed to admit a new one beyond --max-connections or "
      "--max-connections-per-client (default 1). More: new clients are refused; less: connections that are about "
      "to be used are closed");
  add_seconds(command, "idle-timeout", server.idle,
              "Without a request (default 300). More: idle connections stay; less: clients connect again and again");
  add_seconds(command, "answer-timeout", server.stall,
              "Without any byte of an answer being taken (default 30). More: stuck clients hold memory; less: slow "
              "networks are cut off");
  add_seconds(command, "ping-interval", server.ping,
              "Silence of a WebSocket before its client is pinged; after twice that it is gone (default 30). More: "
              "vanished clients stay; less: traffic, and networks with gaps are cut off");
  add_seconds(command, "resume-time", server.sessions.time,
              "That a client whose connection is gone may take to come back to its views (default 180). More: memory; "
              "less: it opens them anew, by itself");
  add_count(command, "max-resumes", server.sessions.sessions,
            "Clients that may come back, at a time (default 256; 0: none). More: memory, --max-views of --resume-view "
            "for each; less: they open their views anew",
            kOrNone);
  add_size(command, "resume-view", server.sessions.view_bytes,
           "What is kept of a view whose client may come back (default 8K; a larger one is opened anew). More: memory; "
           "less: views with many clip boxes are opened anew",
           {1, kMebibyte});
  add_seconds(command, "grace-time", server.grace,
              "Between the signal to stop, when /readyz begins to answer 503, and the end of listening (default 0; a "
              "second signal ends it). More: it stops later; less: a balancer still sends clients");
  add_seconds(command, "leave-time", server.leave,
              "Then, over which clients with views are sent away one after the other (default 0; a second signal ends "
              "it). More: it stops later; less: they come to other servers all at once");
  add_seconds(command, "drain-timeout", server.drain,
              "For what is outstanding when the server stops (default 5). More: it stops later; less: pictures are "
              "given up");
}

}  // namespace

void add_cache_flags(CLI::App& command, ScanCacheConfig& cache) {
  command.add_option("--cache", cache.folder, "Folder for the models of scans (default ~/.cache/surfcast)")
      ->envname(protocol::environment_name("cache"));
  add_size(command, "cache-size", cache.bytes,
           "Models of scans that are kept there (default 20G, or half of what the disk would have free without them). "
           "More: disk; less: scans are built again");
  add_size(command, "build-memory", cache.build_memory,
           "Memory for building a model of a scan (default: a quarter of the machine's). More: less for the rest; "
           "less: large scans are built in more parts");
  add_radius_flag(command, cache.radii)->envname(protocol::environment_name("radii"));
  add_mesh_flags(command, cache.meshes);
}

void add_build_flags(CLI::App& command, PreviewRule& previews, size_t& threads) {
  add_count(
      command, "preview-points", previews.points,
      "Points of a scan that its first preview is made of (default 250000; 0: no previews). More: it is finer, and "
      "comes later; less: coarser, and sooner",
      {0, 1'000'000'000});
  add_size(command, "preview-from", previews.least_bytes,
           "File of a scan from which on there is a preview (default 4M). More: nothing is seen of larger scans before "
           "they are built; less: small scans are complete later",
           {0, UINT64_MAX});
  add_count(
      command, "build-threads", threads,
      "Threads that build a model of a scan (default: one a core). More: memory and time of other programs; less: "
      "scans are complete later",
      kThreads);
}

void add_upload_flags(CLI::App& command, net::UploadConfig& uploads) {
  command
      .add_option(
          "--uploads", uploads.folder,
          "Folder for scans that clients send, by dropping them on the viewer's page or with PUT; its scans are "
          "served too (default: none are taken)")
      ->envname(protocol::environment_name("uploads"))
      ->check(CLI::ExistingDirectory);
  add_size(command, "upload-size", uploads.bytes,
           "One scan that a client sends (default 10G). More: one client fills the disk; less: larger scans are "
           "refused");
  add_size(command, "upload-total", uploads.total_bytes,
           "All scans in the folder (default 100G). More: clients fill the disk; less: scans are refused once it is "
           "full");
  add_count(
      command, "max-uploads", uploads.at_once,
      "Scans that are received at a time (default 2). More: disk and network taken from others; less: clients are "
      "told to try again");
  add_seconds(command, "upload-timeout", uploads.timeout,
              "For each 64 KiB of a scan (default 30). More: stuck clients hold a place; less: slow networks are cut "
              "off");
}

void add_annotation_flags(CLI::App& command, net::AnnotationConfig& annotations) {
  command
      .add_option("--annotations", annotations.folder,
                  "Folder of saved views and annotations, a file of JSON for each model; clients read those of models "
                  "that they may see, and write them with PUT (default: none are kept)")
      ->envname(protocol::environment_name("annotations"))
      ->check(CLI::ExistingDirectory);
  add_size(command, "annotations-size", annotations.bytes,
           "Saved views and annotations of one model (default 256K). More: one client fills more of the disk; less: "
           "fewer of them");
}

void add_renderer_flags(CLI::App& command, render::RendererConfig& renderer) {
  add_size(command, "gpu-memory", renderer.gpu_bytes,
           "For surfels on the GPU (default: a quarter of what is free there, in software an eighth of the host's). "
           "More: less for frames and other programs; less: coarser pictures of large scans",
           {kMebibyte, UINT64_MAX});
  add_size(command, "host-memory", renderer.host_bytes,
           "For decoded blocks that may come back to the GPU (default: a quarter of what is available, in software an "
           "eighth). More: less for other programs; less: blocks are decoded again",
           {kMebibyte, UINT64_MAX});
  add_count(command, "decoders", renderer.decoders,
            "Threads that decode blocks (default: one a core). More: processor time; less: pictures wait for blocks",
            kThreads);
}

void add_worker_flags(CLI::App& command, WorkerFlags& worker) {
  add_count(command, "workers", worker.workers,
            "Processes that decode models and draw (default 1, and one for each of --pick-threads and for searches; 0: "
            "the server itself, which then ends with the driver or a block that crashes it)",
            {0, 1});
  add_seconds(
      command, "worker-timeout", worker.silence,
      "Without a sign of a worker that draws or answers before it is replaced (default 60). More: a driver that "
      "hangs is waited for; less: slow devices are taken for hung");
  add_size(command, "query-memory", worker.query_bytes,
           "Memory of each process that answers picks, profiles and exports (default 8G; 0: no limit). More: a damaged "
           "model takes more memory before its answer fails; less: large answers fail",
           {0, UINT64_MAX});
  command
      .add_option("--worker-readable", worker.readable,
                  "File or folder that a driver reads beside system libraries and devices; may be repeated")
      ->envname(protocol::environment_name("worker-readable"))
      ->type_name("PATH");
  command
      .add_flag("--no-worker-sandbox", worker.no_sandbox,
                "Let the workers read files, reach the network and start programs like the server")
      ->envname(protocol::environment_name("no-worker-sandbox"));
}

void add_picture_flags(CLI::App& command, service::ServiceLimits& limits) {
  add_count(command, "max-pixels", limits.pixels,
            "Pixels of one picture (default 33554432). More: memory and time of one picture; less: refused sooner",
            {1, uint64_t{1} << 28});
  add_count(command, "max-side", limits.side,
            "Pixels of its longer side (default 16384, the most there may be). Less: refused sooner", {1, 16384});
}

void add_pick_cache_flag(CLI::App& command, service::PickLimits& limits) {
  add_size(command, "pick-cache", limits.block_bytes,
           "Decoded blocks kept for picks (default 64M). More: memory; less: they are decoded for every pick");
}

void add_server_flags(CLI::App& command, service::ServiceLimits& service, render::RendererConfig& renderer,
                      net::ServerConfig& server, net::SiteLimits& viewer) {
  add_size(command, "motion-upload", renderer.upload_bytes,
           "Blocks stored on the GPU in one picture in motion (default 16M). More: pictures in motion wait; less: "
           "detail arrives later");
  add_count(command, "motion-glyphs", renderer.motion_glyphs,
            "Ellipsoids of a picture in motion for each surfel that a surface over the whole picture has (default 2). "
            "More: frames are drawn smaller; less: coarser ellipsoids while the view moves",
            {1, 1'000'000});
  add_count(command, "remembered-views", renderer.viewers,
            "Views of one model whose motion is remembered (default 64). More: memory; less: detail flickers where "
            "more than these move");
  add_queue_flags(command, service);
  add_pick_flags(command, service.picks);
  add_connection_flags(command, server);
  add_request_flags(command, server);
  add_time_flags(command, server);
  add_size(command, "viewer-memory", viewer.bytes,
           "The viewer's files, which stay in memory (default 64M). More: memory; less: large viewers are refused");
  add_count(command, "viewer-files", viewer.files,
            "Number of them (default 1000). More: a folder given by mistake is read for long; less: refused");
}

}  // namespace surfcast::cmd
