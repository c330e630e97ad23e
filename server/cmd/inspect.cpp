#include <iostream>
#include <memory>
#include <string>
#include <utility>

#include "builder/input_files.h"
#include "cmd/commands.h"
#include "cmd/in_place_flags.h"
#include "cmd/input_summary.h"
#include "cmd/model_summary.h"
#include "cmd/store_flags.h"
#include "cmd/verify_model.h"
#include "model/format.h"
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
  InPlaceOptions in_place;
};

/// A file that is no model may be one that a model is built of. What is neither is reported as no model.
Status inspect_input(const InspectOptions& options, Error no_model) {
  if (options.verify) return fail(std::move(no_model));
  const Result<std::string> summary = summarize_input(options.model, options.json);
  if (!summary && builder::kind_of_input(options.model) == builder::InputKind::kScan) return fail(std::move(no_model));
  if (!summary) return fail(summary.error());
  std::cout << *summary;
  return {};
}

Status inspect(const InspectOptions& options) {
  const object_store::ObjectStore store(options.store);
  const bool stored = object_store::is_object_url(options.model);
  const InPlaceOpener in_place(store, options.in_place, nullptr);
  const std::string shown = stored ? object_store::shown_url(options.model) : options.model;
  const Result<model::ModelFile> model = in_place.opens(options.model) ? in_place.open(options.model, shown)
                                         : stored                      ? store.open(options.model, shown)
                                                                       : model::ModelFile::open(options.model);
  if (!model && !stored && model.error().message.ends_with(model::kNoModel)) {
    return inspect_input(options, model.error());
  }
  if (!model) return fail(model.error());
  if (options.verify) {
    if (Status status = verify_model(*model); !status) return status;
  }
  Result<model::Georeference> georeference = model->georeference();
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
  CLI::App* command = app.add_subcommand("inspect", "Print the contents of a model, or of a file that one is built of");
  command->add_option("MODEL", options->model, "Model file or its URL, scan, volume, mesh, Gaussians or tensors")
      ->required();
  command->add_flag("--json", options->json, "Print JSON");
  command->add_flag("--verify", options->verify, "Check every checksum and decode every block");
  add_store_flags(*command, options->store);
  add_in_place_flags(*command, options->in_place);
  command->callback([options, &outcome] { outcome = inspect(*options); });
}

}  // namespace surfcast::cmd
