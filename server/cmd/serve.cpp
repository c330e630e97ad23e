#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <climits>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <sys/resource.h>
#include <unistd.h>

#include "base/atomic_file.h"
#include "base/contract.h"
#include "base/log.h"
#include "base/log_format.h"
#include "base/repeat.h"
#include "builder/input_files.h"
#include "cmd/commands.h"
#include "cmd/find_models.h"
#include "cmd/gpu_flag.h"
#include "cmd/limit_flags.h"
#include "cmd/log_device.h"
#include "cmd/program_builder.h"
#include "cmd/scan_builds.h"
#include "cmd/settings.h"
#include "cmd/store_flags.h"
#include "cmd/store_folders.h"
#include "cmd/worker_role.h"
#include "net/server.h"
#include "object_store/object_url.h"
#include "protocol/endpoint.h"
#include "protocol/request_flags.h"
#include "protocol/validate.h"
#include "service/model_name.h"
#include "service/render_service.h"
#include "service/renderer_factories.h"
#include "worker/worker_queries.h"
#include "worker/worker_renderer.h"

namespace surfcast::cmd {
namespace {

struct ServeCommand {
  std::vector<std::filesystem::path> paths;
  std::string listen = "127.0.0.1:7600";
  ScanCacheConfig cache;
  PreviewRule previews;
  size_t build_threads = 0;  ///< 0: one a core
  std::filesystem::path viewer;
  net::SiteLimits viewer_limits;
  render::RendererConfig renderer;
  GpuSelection gpus;
  WorkerFlags worker;
  service::ServiceLimits service;
  net::ServerConfig server;
  object_store::StoreConfig store;
  uint64_t block_cache = 0;
  InPlaceOptions in_place;
  std::chrono::milliseconds store_refresh{60'000};
  std::chrono::milliseconds model_refresh{2'000};
  std::filesystem::path certificate;
  std::filesystem::path key;
  LogFormat log_format = LogFormat::kText;
  bool no_shader_warm_up = false;
  bool insecure = false;  ///< for everybody, without TLS or without tokens
};

/// Where the viewer is when nobody says: where it is built, or where it is installed. Empty: nowhere.
std::filesystem::path find_viewer() {
  namespace fs = std::filesystem;
  std::error_code code;
  const fs::path programs = fs::read_symlink("/proc/self/exe", code).parent_path();
  for (const char* place : {"../client/web/dist", "../share/surfcast/viewer"}) {
    fs::path folder = (programs / place).lexically_normal();
    if (fs::is_regular_file(folder / "index.html", code)) return folder;
  }
  return {};
}

/// The name of this machine, by which clients of its network call it. Nobody else can make the name lead elsewhere.
void add_machine_name(std::vector<std::string>& hosts) {
  std::array<char, HOST_NAME_MAX + 1> name{};
  if (::gethostname(name.data(), HOST_NAME_MAX) == 0) hosts.emplace_back(name.data());
}

bool is_loopback(const std::string& host) {
  return host == "localhost" || host == "::1" || host.starts_with("127.");
}

/// What is missing for a server that others can reach; empty: nothing.
std::string missing_guard(const net::ServerConfig& server) {
  const bool tls = !server.tls.certificate.empty();
  if (is_loopback(server.host) || (tls && !server.tokens.empty())) return {};
  if (tls) return "--tokens";
  return server.tokens.empty() ? "--tls-certificate and --tokens" : "--tls-certificate";
}

/// Where others can reach the port without encryption or without tokens, that is said.
void warn_of_strangers(const net::ServerConfig& server) {
  const std::string missing = missing_guard(server);
  if (missing.empty()) return;
  spdlog::warn("without {}, whoever reaches {} may {}: put a proxy before it that sees to that", missing, server.host,
               server.tokens.empty() ? "see all models and order pictures" : "read along");
}

/// Each connection is a descriptor; models, the log and the device take some more.
void allow_descriptors(size_t connections) {
  constexpr size_t kOthers = 128;
  rlimit limit{};
  if (::getrlimit(RLIMIT_NOFILE, &limit) != 0) return;
  limit.rlim_cur = limit.rlim_max;
  ::setrlimit(RLIMIT_NOFILE, &limit);
  if (limit.rlim_max >= connections + kOthers) return;
  spdlog::warn("the system allows {} descriptors, --max-connections {} may need more", limit.rlim_max, connections);
}

/// Null when there is no viewer and none was asked for.
Result<std::shared_ptr<const net::StaticFiles>> read_viewer(const std::filesystem::path& wanted,
                                                            const net::SiteLimits& limits) {
  const std::filesystem::path folder = wanted.empty() ? find_viewer() : wanted;
  if (folder.empty()) return nullptr;
  Result<net::StaticFiles> files = net::StaticFiles::read(folder, limits);
  if (!files) return fail(files);
  return std::make_shared<const net::StaticFiles>(std::move(*files));
}

/// Serves a scan of the folder for uploads. It hides no other model.
Status serve_uploaded(const std::filesystem::path& scan, const service::ModelCatalogue& models, ScanBuilds& builds) {
  if (Status header = builder::check_input(scan); !header) return header;
  if (!models.has(service::model_name(scan)) && builds.add(scan)) return {};
  return fail(ErrorKind::kInvalidInput, scan.string() + ": another model is served under that name");
}

/// Says which files of the folders of models are scans, which are served only where they are named.
void warn_of_unserved_scans(const std::vector<std::filesystem::path>& folders) {
  for (const std::filesystem::path& folder : folders) {
    const std::vector<std::filesystem::path> scans = builder::inputs_in(folder);
    if (scans.empty()) continue;
    spdlog::warn(
        "{}: only models (.surf) in a folder are served; {} scan{} skipped, such as {}: name a scan to build and serve "
        "it",
        folder.string(), scans.size(), scans.size() == 1 ? "" : "s", scans.front().filename().string());
  }
}

/// Serves the scans that clients have sent to servers before this one.
void serve_former_uploads(const net::UploadConfig& uploads) {
  if (uploads.folder.empty()) return;
  for (const std::filesystem::path& folder : net::upload_folders(uploads)) remove_abandoned_files(folder);
  for (const std::filesystem::path& scan : net::uploaded_scans(uploads)) {
    if (const Status served = uploads.serve(scan); !served) spdlog::warn("{}", served.error().message);
  }
}

/// Drivers keep compiled shaders in a folder that only workers use, so that the next worker draws sooner.
void allow_shader_cache(const ScanCacheConfig& cache, worker::WorkerConfig& config) {
  const Result<std::filesystem::path> folder = ready_cache_folder(cache);
  if (!folder) return;
  const std::filesystem::path shaders = *folder / "shaders";
  std::error_code code;
  std::filesystem::create_directories(shaders, code);
  config.writable = {shaders.string()};
  for (const char* variable : {"MESA_SHADER_CACHE_DIR", "__GL_SHADER_DISK_CACHE_PATH"}) {
    config.environment.push_back(std::string(variable) + "=" + shaders.string());
    const char* const own = std::getenv(variable);
    if (own == nullptr) continue;
    std::filesystem::create_directories(own, code);
    config.writable.emplace_back(own);
  }
}

/// What is drawn on one of the devices. Those of one machine share its memory.
render::RendererConfig renderer_on(int device, size_t devices, render::RendererConfig config) {
  config.gpu = device;
  config.sharers = static_cast<unsigned>(devices);
  if (config.host_bytes) *config.host_bytes /= devices;
  return config;
}

/// Where pictures are drawn: in a worker process, or in this one.
Result<service::ModelRendererFactory> make_renderers(const ServeCommand& command,
                                                     const render::RendererConfig& renderer,
                                                     worker::WorkerCounts& counts, std::function<void()> on_reset) {
  if (command.worker.workers == 0) return service::local_renderers(renderer, std::move(on_reset));
  Result<std::vector<std::string>> program = worker_command(kRenderWorker);
  if (!program) return fail(program);
  worker::WorkerConfig config;
  config.command = std::move(*program);
  config.renderer = renderer;
  config.log_format = command.log_format;
  config.sandbox = !command.worker.no_sandbox;
  config.readable = command.worker.readable;
  config.pixels = command.service.pixels;
  allow_shader_cache(command.cache, config);
  config.silence = command.worker.silence;
  return worker::worker_renderers(config, counts);
}

/// Where picks, profiles and the like are answered; null: in this process.
Result<std::shared_ptr<service::ModelQueries>> make_queries(const ServeCommand& command, worker::WorkerCounts& counts) {
  if (command.worker.workers == 0) return nullptr;
  Result<std::vector<std::string>> program = worker_command(kQueryWorker);
  if (!program) return fail(program);
  worker::QueryWorkerConfig config;
  config.command = std::move(*program);
  config.log_format = command.log_format;
  config.sandbox = !command.worker.no_sandbox;
  config.silence = command.worker.silence;
  config.memory = command.worker.query_bytes;
  config.limits = command.service.picks;
  return worker::worker_queries(config, counts);
}

net::ProcessGauges gauges_of(const worker::WorkerCounts& counts) {
  return {counts.started, counts.ended, counts.quarantined};
}

/// Where models are that a command line names, or that clients may send.
struct ModelPlaces {
  bool files = false;
  bool stores = false;  ///< or scans in place
};

ModelPlaces places_of(const ServeCommand& command) {
  const auto drawn_here = [&command](const std::filesystem::path& path) {
    return object_store::is_object_url(path.string()) || is_in_place(path, command.in_place);
  };
  const bool uploads = !command.server.uploads.folder.empty();
  return {uploads || !std::ranges::all_of(command.paths, drawn_here), std::ranges::any_of(command.paths, drawn_here)};
}

/// A worker reaches no network and opens no file, so that models of stores and scans in place are drawn here. Without
/// others there is no need for workers.
void draw_stores_here(ServeCommand& command, const ModelPlaces& places) {
  if (command.worker.workers == 0 || !places.stores) return;
  spdlog::warn("models of stores and scans in place are drawn by the server itself, without a sandbox");
  if (!places.files) command.worker.workers = 0;
}

service::ShaderWarmUp warm_up_of(const ServeCommand& command) {
  return command.no_shader_warm_up ? service::ShaderWarmUp::kOff : service::ShaderWarmUp::kOn;
}

/// Who draws models of stores beside those of files: this process. None where there are not both.
std::optional<service::Drawers> store_drawers(const ServeCommand& command, const service::ModelCatalogue& models,
                                              const ModelPlaces& places, std::function<void()> on_reset) {
  if (!places.files || !places.stores) return std::nullopt;
  return service::Drawers{service::catalogue_renderers(models,
                                                       service::local_renderers(command.renderer, std::move(on_reset)),
                                                       warm_up_of(command), service::ModelPlace::kStore)};
}

/// Who draws on each of the devices.
Result<std::vector<service::FrameRendererFactory>> make_drawers(const ServeCommand& command,
                                                                const std::vector<int>& devices,
                                                                const service::ModelCatalogue& models,
                                                                const ModelPlaces& places, worker::WorkerCounts& counts,
                                                                const std::function<void()>& on_reset) {
  const auto own_place = places.files ? service::ModelPlace::kFile : service::ModelPlace::kAnywhere;
  std::vector<service::FrameRendererFactory> drawers;
  for (const int device : devices) {
    Result<service::ModelRendererFactory> renderers =
        make_renderers(command, renderer_on(device, devices.size(), command.renderer), counts, on_reset);
    if (!renderers) return fail(renderers);
    drawers.push_back(service::catalogue_renderers(models, std::move(*renderers), warm_up_of(command), own_place));
  }
  return drawers;
}

Status serve(ServeCommand command) {
  const Result<std::vector<int>> devices = devices_of(command.gpus);
  if (!devices) return fail(devices);
  command.renderer.gpu = devices->front();
  const ModelPlaces places = places_of(command);
  draw_stores_here(command, places);
  Result<std::shared_ptr<const net::StaticFiles>> viewer = read_viewer(command.viewer, command.viewer_limits);
  if (!viewer) return fail(viewer);
  command.server.viewer = std::move(*viewer);
  Result<std::shared_ptr<model::BlockCache>> blocks = open_block_cache(command.block_cache, command.cache);
  if (!blocks) return fail(blocks);
  command.store.log_lines = command.server.log_lines;
  const object_store::ObjectStore store(command.store, *blocks);
  const InPlaceOpener in_place(store, command.in_place, std::move(*blocks));
  Result<NamedPaths> paths = sort_paths(command.paths, store, in_place);
  if (!paths) return fail(paths);
  warn_of_unserved_scans(paths->folders);
  service::ModelCatalogue models(std::move(paths->models), std::move(paths->folders), &store);
  StoreFolders stores(store, models, std::move(paths->stores));
  if (Status status = stores.list(); !status) return status;
  if (places.stores) stores.watch(command.store_refresh);
  std::atomic<bool> gpu_reset = false;
  const auto on_reset = [&gpu_reset] {
    gpu_reset = true;
    ::kill(::getpid(), SIGTERM);
  };
  worker::WorkerCounts workers;
  worker::WorkerCounts query_workers;
  Result<std::vector<service::FrameRendererFactory>> drawers =
      make_drawers(command, *devices, models, places, workers, on_reset);
  if (!drawers) return fail(drawers);
  Result<std::shared_ptr<service::ModelQueries>> queries = make_queries(command, query_workers);
  if (!queries) return fail(queries);
  service::FrameRendererFactory first = std::move(drawers->front());
  drawers->erase(drawers->begin());
  const auto service =
      service::RenderService::start(models, std::move(first), command.service, std::move(*queries),
                                    store_drawers(command, models, places, on_reset), std::move(*drawers));
  if (!service) return fail(service);
  if (command.worker.workers > 0) {
    command.server.workers = [&] { return net::WorkerGauges{gauges_of(workers), gauges_of(query_workers)}; };
  }
  for (const picture::DeviceInfo& device : (*service)->devices()) log_device(device, command.renderer);
  add_machine_name(command.server.hosts);
  ScanBuilds* builder = nullptr;  // set before the server runs
  net::UploadConfig& uploads = command.server.uploads;
  uploads.extensions = builder::input_extensions();
  uploads.data_extensions = builder::data_extensions();
  uploads.taken = [&models](const std::string& name) { return models.has(name); };
  uploads.serve = [&](const std::filesystem::path& scan) { return serve_uploaded(scan, models, *builder); };
  const auto server = net::Server::create(**service, command.server);
  if (!server) return fail(server);
  models.on_change([&](bool published) {
    (*service)->models_changed();
    if (published) (*server)->models_changed();
  });
  const std::jthread watch(
      [&](const std::stop_token& stop) { repeat(stop, command.model_refresh, [&] { models.look_for_replaced(); }); });
  remove_abandoned(command.cache);
  ScanBuilds builds(models, make_program_builder(command.cache, command.build_threads), command.previews);
  for (const std::filesystem::path& scan : paths->scans) SURFCAST_EXPECTS(builds.add(scan));  // sort_paths saw to it
  builder = &builds;
  serve_former_uploads(uploads);
  const size_t count = models.names().size();
  if (count == 0) spdlog::warn("there are no models yet; those that appear in the folders will be served");
  warn_of_strangers(command.server);
  allow_descriptors(command.server.clients.connections);
  const protocol::Endpoint bound{command.server.host, (*server)->port()};
  std::cout << "surfcastd: serving " << count << (count == 1 ? " model" : " models") << " at "
            << (command.server.tls.certificate.empty() ? "http://" : "https://") << protocol::to_string(bound) << '/'
            << std::endl;
  (*server)->run(/*until_signal=*/true);
  if (gpu_reset)
    return fail(ErrorKind::kUnavailable, "the GPU was reset: the service manager has to restart the server");
  spdlog::info("stopped");
  return {};
}

void add_tls_flags(CLI::App& sub, ServeCommand& command) {
  sub.add_option("--tls-certificate", command.certificate,
                 "Certificate chain in PEM for https://, wss:// and tcps:// on the same port, or a folder with tls.crt "
                 "and tls.key or fullchain.pem and privkey.pem; read again when it changes and on SIGHUP")
      ->envname(protocol::environment_name("tls-certificate"))
      ->type_name("PATH");
  sub.add_option("--tls-key", command.key, "Its private key in PEM")
      ->envname(protocol::environment_name("tls-key"))
      ->type_name("PATH");
  sub.add_option("--tokens", command.server.tokens,
                 "File of the tokens of those who may ask for models, see surfcastd token; read again when it changes "
                 "and on SIGHUP (default: none are required)")
      ->envname(protocol::environment_name("tokens"))
      ->type_name("FILE");
  sub.add_flag("--insecure-listen", command.insecure,
               "Listen beyond the loopback without TLS or without tokens, behind a proxy or in a trusted network")
      ->envname(protocol::environment_name("insecure-listen"));
}

}  // namespace

void add_serve_command(CLI::App& app, Status& outcome) {
  auto command = std::make_shared<ServeCommand>();
  CLI::App* sub = app.add_subcommand("serve", "Serve models over TCP and HTTP");
  sub->add_option("PATH", command->paths,
                  "Model files, folders of model files, URLs of both (those of folders end with a slash), and scans, "
                  "which may be folders (EPT, Potree, 3D Tiles) (default: the current folder)");
  sub->add_option("--listen", command->listen, "HOST:PORT to listen on; port 0: any free port (default 127.0.0.1:7600)")
      ->envname(protocol::environment_name("listen"));
  sub->add_option("--viewer", command->viewer, "Folder of the browser viewer (default: the one built or installed)")
      ->envname(protocol::environment_name("viewer"));
  sub->add_option(
         "--host", command->server.hosts,
         "Name that clients of HTTP may call the server by, beside addresses, localhost and the machine's name; "
         "may be repeated; *: any name")
      ->envname(protocol::environment_name("host"));
  sub->add_option("--allow-origin", command->server.allowed_origins,
                  "Web origin whose pages may connect, like https://example.org; may be repeated")
      ->envname(protocol::environment_name("allow-origin"));
  sub->add_option("--target-fps", command->server.target_fps,
                  "Frames per second that moving views hold by adapting their quality (default 30)")
      ->envname(protocol::environment_name("target-fps"))
      ->type_name("NUMBER")
      ->check(CLI::Range(1.0, protocol::kMaxFramesPerSecond));
  add_tls_flags(*sub, *command);
  add_gpus_flag(*sub, command->gpus, "models are spread over them");
  add_renderer_flags(*sub, command->renderer);
  sub->add_flag("--no-shader-warm-up", command->no_shader_warm_up,
                "Compile shaders when a picture needs them, not before: an idle server then uses no processor, and the "
                "first picture with an option waits for the driver")
      ->envname(protocol::environment_name("no-shader-warm-up"));
  add_worker_flags(*sub, command->worker);
  add_cache_flags(*sub, command->cache);
  add_build_flags(*sub, command->previews, command->build_threads);
  add_upload_flags(*sub, command->server.uploads);
  add_annotation_flags(*sub, command->server.annotations);
  add_picture_flags(*sub, command->service);
  add_store_flags(*sub, command->store);
  add_block_cache_flag(*sub, command->block_cache);
  add_in_place_flags(*sub, command->in_place);
  add_seconds(*sub, "store-refresh", command->store_refresh,
              "Before folders in stores are listed again, and open models are looked after (default 60). More: new and "
              "replaced "
              "models are seen later; less: requests");
  add_seconds(*sub, "model-refresh", command->model_refresh,
              "Before the files of models that views show are looked at again (default 2). More: views at rest show a "
              "replaced file later; less: requests of the file system");
  add_server_flags(*sub, command->service, command->renderer, command->server, command->viewer_limits);
  sub->add_option("--log-format", command->log_format, "Lines of the log: text or json (default text)")
      ->envname(protocol::environment_name("log-format"))
      ->transform(CLI::CheckedTransformer(
          std::map<std::string, LogFormat>{{"text", LogFormat::kText}, {"json", LogFormat::kJson}}))
      ->type_name("FORMAT");
  sub->add_option("--audit-log", command->server.audit,
                  "File that tells who asked for what, one JSON object a line (default: none); SIGHUP opens it again")
      ->envname(protocol::environment_name("audit-log"))
      ->type_name("FILE");
  sub->add_option_function<std::vector<std::string>>(
         "--trusted-proxy",
         [command](const std::vector<std::string>& texts) {
           Result<net::Networks> networks = net::Networks::parse(texts);
           if (!networks) throw CLI::ValidationError("--trusted-proxy", networks.error().message);
           command->server.trusted_proxies = std::move(*networks);
         },
         "Address or network of proxies that tell their clients' addresses by the PROXY protocol")
      ->envname(protocol::environment_name("trusted-proxy"))
      ->type_name("NETWORK");
  sub->callback([command, &outcome] {
    set_log_format(command->log_format);
    const Result<protocol::Endpoint> endpoint = protocol::parse_endpoint(command->listen);
    if (!endpoint) throw CLI::ValidationError("--listen", endpoint.error().message);
    command->server.host = endpoint->host;
    command->server.port = endpoint->port;
    const auto certificate = tls::find_certificate(command->certificate, command->key);
    if (!certificate) throw CLI::ValidationError("--tls-certificate", certificate.error().message);
    command->server.tls = *certificate;
    if (const std::string missing = missing_guard(command->server); !missing.empty() && !command->insecure) {
      throw CLI::ValidationError("--listen", command->server.host + " can be reached by others: " + missing +
                                                 " are for that, or --insecure-listen");
    }
    if (command->paths.empty()) command->paths.emplace_back(".");
    outcome = serve(*command);
  });
}

}  // namespace surfcast::cmd
