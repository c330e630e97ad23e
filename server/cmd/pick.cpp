#include <filesystem>
#include <future>
#include <memory>
#include <utility>
#include <vector>

#include "access/authorization.h"
#include "cmd/commands.h"
#include "cmd/find_models.h"
#include "cmd/limit_flags.h"
#include "cmd/store_flags.h"
#include "net/convert.h"
#include "protocol/request_flags.h"
#include "service/pick_service.h"

namespace surfcast::cmd {
namespace {

struct PickCommand {
  std::vector<std::filesystem::path> models;
  protocol::PickFlags flags;
  ScanCacheConfig cache;
  service::PickLimits limits;
  object_store::StoreConfig store;
  uint64_t block_cache = 0;
  InPlaceOptions in_place;
};

Status pick(const PickCommand& command) {
  Result<std::shared_ptr<model::BlockCache>> blocks = open_block_cache(command.block_cache, command.cache);
  if (!blocks) return fail(blocks);
  const object_store::ObjectStore store(command.store, *blocks);
  const InPlaceOpener in_place(store, command.in_place, std::move(*blocks));
  const Result<FoundModel> found = find_shown_model(command.models, command.cache, store, in_place);
  if (!found) return fail(found);
  const service::ModelCatalogue& models = *found->models;
  Result<service::PickJob> job = command.flags.request(found->name).and_then([](const wire::PickSurfel& request) {
    return net::to_job(request, access::Rights::unlimited().authorize(request.picture().model()));
  });
  if (!job) return fail(job);
  std::promise<Result<std::optional<service::PickedPoint>>> promise;
  service::PickService service(models, command.limits);
  service.pick(std::move(*job), [&promise](auto picked) { promise.set_value(std::move(picked)); });
  return promise.get_future().get().and_then([&](const std::optional<service::PickedPoint>& picked) {
    wire::PickResult result;
    net::to_wire(picked, result);
    return command.flags.print(result);
  });
}

}  // namespace

void add_pick_command(CLI::App& app, Status& outcome) {
  auto command = std::make_shared<PickCommand>();
  CLI::App* sub = app.add_subcommand("pick", "Print the surfel at a pixel of a picture of a model or scan");
  sub->add_option("MODEL", command->models, "Model file, its URL, or scan; several are shown together")->required();
  command->flags.add_to(*sub);
  add_cache_flags(*sub, command->cache);
  add_pick_cache_flag(*sub, command->limits);
  add_store_flags(*sub, command->store);
  add_block_cache_flag(*sub, command->block_cache);
  add_in_place_flags(*sub, command->in_place);
  sub->callback([command, &outcome] {
    if (Status status = command->flags.check(); !status) throw CLI::ValidationError(status.error().message);
    outcome = pick(*command);
  });
}

}  // namespace surfcast::cmd
