#include <chrono>
#include <filesystem>
#include <future>
#include <memory>
#include <utility>
#include <vector>

#include "access/authorization.h"
#include "base/log.h"
#include "cmd/commands.h"
#include "cmd/find_models.h"
#include "cmd/gpu_flag.h"
#include "cmd/limit_flags.h"
#include "cmd/log_device.h"
#include "cmd/store_flags.h"
#include "cmd/unused_options.h"
#include "net/convert.h"
#include "protocol/request_flags.h"
#include "protocol/save_picture.h"
#include "service/render_service.h"
#include "service/renderer_factories.h"

namespace surfcast::cmd {
namespace {

struct RenderCommand {
  std::vector<std::filesystem::path> models;
  protocol::RequestFlags flags;
  ScanCacheConfig cache;
  render::RendererConfig renderer;
  GpuSelection gpus;
  /// Nobody else waits for the renderer, so the picture takes the time that it takes.
  service::ServiceLimits limits{.queue_timeout = std::chrono::hours(24 * 365)};
  object_store::StoreConfig store;
  uint64_t block_cache = 0;
  InPlaceOptions in_place;
};

Result<wire::Picture> draw_and_wait(service::RenderService& service, const wire::DrawPicture& request) {
  Result<service::PictureJob> job = net::to_job(request, access::Rights::unlimited().authorize(request.model()));
  if (!job) return fail(job);
  std::promise<Result<service::EncodedPicture>> promise;
  service.draw(0, std::move(*job),
               [&promise](Result<service::EncodedPicture> picture) { promise.set_value(std::move(picture)); });
  return promise.get_future().get().map([](service::EncodedPicture picture) {
    wire::Picture message;
    net::to_wire(std::move(picture), message);
    return message;
  });
}

/// Errors of the model are those of the picture.
void warn_of_unused_options(const service::ModelCatalogue& models, const wire::DrawPicture& request) {
  const Result<std::shared_ptr<const model::ModelFile>> model = models.open(request.model());
  if (!model) return;
  for (const std::string& line : unused_options(request, (*model)->info())) spdlog::warn("{}", line);
}

Status render(RenderCommand command) {
  const Result<std::vector<int>> devices = devices_of(command.gpus);
  if (!devices) return fail(devices);
  command.renderer.gpu = devices->front();
  Result<std::shared_ptr<model::BlockCache>> blocks = open_block_cache(command.block_cache, command.cache);
  if (!blocks) return fail(blocks);
  const object_store::ObjectStore store(command.store, *blocks);
  const InPlaceOpener in_place(store, command.in_place, std::move(*blocks));
  const Result<FoundModel> found = find_shown_model(command.models, command.cache, store, in_place);
  if (!found) return fail(found);
  const service::ModelCatalogue& models = *found->models;
  const Result<wire::DrawPicture> request = command.flags.request(found->name);
  if (!request) return fail(request);
  warn_of_unused_options(models, *request);
  const auto service = service::RenderService::start(
      models,
      service::catalogue_renderers(models, service::local_renderers(command.renderer), service::ShaderWarmUp::kOff),
      command.limits);
  if (!service) return fail(service);
  log_device((*service)->devices().front(), command.renderer);
  return protocol::draw_and_save(command.flags, *request,
                                 [&](const wire::DrawPicture& draw) { return draw_and_wait(**service, draw); });
}

}  // namespace

void add_render_command(CLI::App& app, Status& outcome) {
  auto command = std::make_shared<RenderCommand>();
  CLI::App* sub = app.add_subcommand("render", "Draw a picture of a model or scan, or the frames of a camera path");
  sub->add_option("MODEL", command->models, "Model file, its URL, or scan; several are shown together")->required();
  command->flags.add_to(*sub);
  add_gpus_flag(*sub, command->gpus, "the first one draws");
  add_renderer_flags(*sub, command->renderer);
  add_cache_flags(*sub, command->cache);
  add_picture_flags(*sub, command->limits);
  add_store_flags(*sub, command->store);
  add_block_cache_flag(*sub, command->block_cache);
  add_in_place_flags(*sub, command->in_place);
  sub->callback([command, &outcome] {
    if (Status status = command->flags.check(); !status) throw CLI::ValidationError(status.error().message);
    outcome = render(*command);
  });
}

}  // namespace surfcast::cmd
