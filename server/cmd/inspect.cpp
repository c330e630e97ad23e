#include "cmd/inspect.h"

#include <iostream>
#include <memory>
#include <string>
#include <utility>

#include "cmd/model_summary.h"
#include "cmd/store_flags.h"
#include "cmd/verify_model.h"
#include "model/model_file.h"
#include "object_store/object_store.h"
#include "object_store/object_url.h"

namespace surfcast::cmd {
namespace {

struct InspectOptions {
  std::string model;
  bool json = false;
  bool verify = false;
  object_store::StoreConfig store;
};

Status inspect(const InspectOptions& options) {
  const object_store::ObjectStore store(options.store);
  const bool stored = object_store::is_object_url(options.model);
  const Result<model::ModelFile> model = stored ? store.open(options.model) : model::ModelFile::open(options.model);
  if (!model) return fail(model.error());
  if (options.verify) {
    if (Status status = verify_model(*model); !status) return status;
  }
  Result<model::Georeference> georeference = model::load_georeference(model->source());
  if (!georeference) return fail(std::move(georeference.error()));
  ModelSummary summary = summarize(*model, model->source().size());
  summary.georeference = std::move(*georeference);
  std::cout << (options.json ? to_json(summary) : to_text(summary));
  if (options.verify && !options.json) std::cout << "verified: every block\n";
  return {};
}

}  // namespace

void add_inspect_command(CLI::App& app, Status& outcome) {
  auto options = std::make_shared<InspectOptions>();
  CLI::App* command = app.add_subcommand("inspect", "Print the contents of a model file");
  command->add_option("MODEL", options->model, "Model file, or its URL")->required();
  command->add_flag("--json", options->json, "Print JSON");
  command->add_flag("--verify", options->verify, "Check every checksum and decode every block");
  add_store_flags(*command, options->store);
  command->callback([options, &outcome] { outcome = inspect(*options); });
}

}  // namespace surfcast::cmd
