#include "cmd/render.h"

#include <array>
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

Result<EncodedPicture> draw_and_wait(RenderService& service, PictureJob job) {
  std::promise<Result<EncodedPicture>> promise;
  service.draw(0, std::move(job),
               [&promise](Result<EncodedPicture> picture) { promise.set_value(std::move(picture)); });
  return promise.get_future().get();
}

Result<EncodedPicture> draw(const RenderCommand& command) {
  const std::array paths{command.model};
  const Result<std::unique_ptr<ModelCatalogue>> models = find_models(paths, command.cache);
  if (!models) return fail(models.error());
  const Result<wire::DrawPicture> request = command.flags.request((*models)->names().front());
  if (!request) return fail(request.error());
  Result<PictureJob> job = to_job(*request);
  if (!job) return fail(job.error());
  const auto service = RenderService::start(**models, model_painters(**models, command.renderer), {});
  if (!service) return fail(service.error());
  log_device((*service)->device());
  return draw_and_wait(**service, std::move(*job));
}

Status render(const RenderCommand& command) {
  std::error_code ignored;
  if (std::filesystem::is_directory(command.model, ignored)) {
    return fail(ErrorKind::kInvalidInput, command.model.string() + ": is a folder, and one model is wanted");
  }
  Result<EncodedPicture> picture = draw(command);
  if (!picture) return fail(picture.error());
  wire::Picture message;
  to_wire(std::move(*picture), message);
  return save_picture(message, command.flags.output(), command.flags.stats());
}

}  // namespace

void add_render_command(CLI::App& app, Status& outcome) {
  auto command = std::make_shared<RenderCommand>();
  CLI::App* sub = app.add_subcommand("render", "Draw one picture of a model or a scan");
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
