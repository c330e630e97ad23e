#include "cmd/render.h"

#include <filesystem>
#include <future>
#include <memory>
#include <utility>

#include "cmd/find_models.h"
#include "cmd/log_device.h"
#include "net/convert.h"
#include "protocol/request_flags.h"
#include "protocol/save_picture.h"
#include "service/model_painter.h"
#include "service/render_service.h"

namespace surfcast {
namespace {

struct RenderCommand {
  std::filesystem::path model;
  RequestFlags flags;
  std::filesystem::path cache;
  RendererConfig renderer;
};

Result<wire::Picture> draw_and_wait(RenderService& service, const wire::DrawPicture& request) {
  Result<PictureJob> job = to_job(request);
  if (!job) return fail(job.error());
  std::promise<Result<EncodedPicture>> promise;
  service.draw(0, std::move(*job),
               [&promise](Result<EncodedPicture> picture) { promise.set_value(std::move(picture)); });
  Result<EncodedPicture> picture = promise.get_future().get();
  if (!picture) return fail(picture.error());
  wire::Picture message;
  to_wire(std::move(*picture), message);
  return message;
}

Status render(const RenderCommand& command) {
  const Result<std::unique_ptr<ModelCatalogue>> models = find_one_model(command.model, command.cache);
  if (!models) return fail(models.error());
  const Result<wire::DrawPicture> request = command.flags.request((*models)->names().front());
  if (!request) return fail(request.error());
  const auto service = RenderService::start(**models, model_painters(**models, command.renderer), {});
  if (!service) return fail(service.error());
  log_device((*service)->device());
  return draw_and_save(command.flags, *request,
                       [&](const wire::DrawPicture& wish) { return draw_and_wait(**service, wish); });
}

}  // namespace

void add_render_command(CLI::App& app, Status& outcome) {
  auto command = std::make_shared<RenderCommand>();
  CLI::App* sub = app.add_subcommand("render", "Draw a picture of a model or a scan, or the frames of a camera path");
  sub->add_option("MODEL", command->model, "A model file or a scan")->required();
  command->flags.add_to(*sub);
  sub->add_option("--gpu", command->renderer.gpu, "Index of the EGL device (default: the first hardware device)")
      ->envname(environment_name("gpu"))
      ->check(CLI::NonNegativeNumber);
  sub->add_option("--cache", command->cache, "Folder for the models of scans (default ~/.cache/surfcast)")
      ->envname(environment_name("cache"));
  sub->callback([command, &outcome] {
    if (Status status = command->flags.check(); !status) throw CLI::ValidationError(status.error().message);
    outcome = render(*command);
  });
}

}  // namespace surfcast
