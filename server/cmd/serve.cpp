#include "cmd/serve.h"

#include <filesystem>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "base/atomic_file.h"
#include "base/contract.h"
#include "base/log.h"
#include "cmd/find_models.h"
#include "cmd/limit_flags.h"
#include "cmd/log_device.h"
#include "cmd/program_builder.h"
#include "cmd/scan_builds.h"
#include "net/server.h"
#include "protocol/endpoint.h"
#include "protocol/request_flags.h"
#include "protocol/validate.h"
#include "scan/scan_format.h"
#include "scan/scan_stream.h"
#include "service/catalogue_renderer.h"
#include "service/render_service.h"

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
  service::ServiceLimits service;
  net::ServerConfig server;
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

/// Null when there is no viewer and none was asked for.
Result<std::shared_ptr<const net::StaticFiles>> read_viewer(const std::filesystem::path& wanted,
                                                            const net::SiteLimits& limits) {
  const std::filesystem::path folder = wanted.empty() ? find_viewer() : wanted;
  if (folder.empty()) return nullptr;
  Result<net::StaticFiles> files = net::StaticFiles::read(folder, limits);
  if (!files) return fail(files.error());
  return std::make_shared<const net::StaticFiles>(std::move(*files));
}

/// Serves a scan of the folder for uploads. It hides no other model.
Status serve_uploaded(const std::filesystem::path& scan, const service::ModelCatalogue& models, ScanBuilds& builds) {
  if (Status header = scan::check_header(scan); !header) return header;
  if (!models.has(scan.stem().string()) && builds.add(scan)) return {};
  return fail(ErrorKind::kInvalidInput, scan.string() + ": another model is served under that name");
}

/// Serves the scans that clients have sent to servers before this one.
void serve_former_uploads(const net::UploadConfig& uploads) {
  if (uploads.folder.empty()) return;
  remove_abandoned_files(uploads.folder);
  for (const std::filesystem::path& scan : net::uploaded_scans(uploads)) {
    if (const Status served = uploads.serve(scan); !served) spdlog::warn("{}", served.error().message);
  }
}

Status serve(ServeCommand command) {
  Result<std::shared_ptr<const net::StaticFiles>> viewer = read_viewer(command.viewer, command.viewer_limits);
  if (!viewer) return fail(viewer.error());
  command.server.viewer = std::move(*viewer);
  Result<NamedPaths> paths = sort_paths(command.paths);
  if (!paths) return fail(paths.error());
  service::ModelCatalogue models(std::move(paths->models), std::move(paths->folders));
  const auto service =
      service::RenderService::start(models, service::catalogue_renderers(models, command.renderer), command.service);
  if (!service) return fail(service.error());
  log_device((*service)->device(), command.renderer);
  ScanBuilds* builder = nullptr;  // set before the server runs
  net::UploadConfig& uploads = command.server.uploads;
  uploads.extensions = scan::scan_extensions();
  uploads.taken = [&models](const std::string& name) { return models.has(name); };
  uploads.serve = [&](const std::filesystem::path& scan) { return serve_uploaded(scan, models, *builder); };
  const auto server = net::Server::create(**service, command.server);
  if (!server) return fail(server.error());
  models.on_change([&](bool published) {
    (*service)->models_changed();
    if (published) (*server)->models_changed();
  });
  remove_abandoned(command.cache);
  ScanBuilds builds(models, make_program_builder(command.cache, command.build_threads), command.previews);
  for (const std::filesystem::path& scan : paths->scans) SURFCAST_EXPECTS(builds.add(scan));  // sort_paths saw to it
  builder = &builds;
  serve_former_uploads(uploads);
  const size_t count = models.names().size();
  if (count == 0) spdlog::warn("there are no models yet; those that appear in the folders will be served");
  const protocol::Endpoint bound{command.server.host, (*server)->port()};
  std::cout << "surfcastd: serving " << count << (count == 1 ? " model" : " models") << " at http://"
            << protocol::to_string(bound) << '/' << std::endl;
  (*server)->run(/*until_signal=*/true);
  spdlog::info("stopped");
  return {};
}

}  // namespace

void add_serve_command(CLI::App& app, Status& outcome) {
  auto command = std::make_shared<ServeCommand>();
  CLI::App* sub = app.add_subcommand("serve", "Serve models over TCP and HTTP");
  sub->add_option("PATH", command->paths,
                  "Model files, folders of model files, and scans (default: the current folder)");
  sub->add_option("--listen", command->listen, "HOST:PORT to listen on; port 0: any free port (default 127.0.0.1:7600)")
      ->envname(protocol::environment_name("listen"));
  sub->add_option("--viewer", command->viewer, "Folder of the browser viewer (default: the one built or installed)")
      ->envname(protocol::environment_name("viewer"));
  sub->add_option("--allow-origin", command->server.allowed_origins,
                  "Web origin whose pages may connect, like https://example.org; may be repeated")
      ->envname(protocol::environment_name("allow-origin"));
  sub->add_option("--target-fps", command->server.target_fps,
                  "Frames per second that moving views hold by adapting their quality (default 30)")
      ->envname(protocol::environment_name("target-fps"))
      ->type_name("NUMBER")
      ->check(CLI::Range(1.0, protocol::kMaxFramesPerSecond));
  add_renderer_flags(*sub, command->renderer);
  add_cache_flags(*sub, command->cache);
  add_build_flags(*sub, command->previews, command->build_threads);
  add_upload_flags(*sub, command->server.uploads);
  add_picture_flags(*sub, command->service);
  add_server_flags(*sub, command->service, command->renderer, command->server, command->viewer_limits);
  sub->callback([command, &outcome] {
    const Result<protocol::Endpoint> endpoint = protocol::parse_endpoint(command->listen);
    if (!endpoint) throw CLI::ValidationError("--listen", endpoint.error().message);
    command->server.host = endpoint->host;
    command->server.port = endpoint->port;
    if (command->paths.empty()) command->paths.emplace_back(".");
    outcome = serve(*command);
  });
}

}  // namespace surfcast::cmd
