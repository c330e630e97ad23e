#include "cmd/inspect.h"

#include <filesystem>
#include <iostream>
#include <memory>
#include <string>
#include <utility>

#include "cmd/model_summary.h"
#include "cmd/verify_model.h"
#include "model/model_file.h"

namespace surfcast::cmd {
namespace {

struct InspectOptions {
  std::string model;
  bool json = false;
  bool verify = false;
};

Status inspect(const InspectOptions& options) {
  const Result<model::ModelFile> model = model::ModelFile::open(options.model);
  if (!model) return fail(model.error());
  if (options.verify) {
    if (Status status = verify_model(*model); !status) return status;
  }
  Result<model::Georeference> georeference = model::load_georeference(options.model);
  if (!georeference) return fail(std::move(georeference.error()));
  ModelSummary summary = summarize(*model, std::filesystem::file_size(options.model));
  summary.georeference = std::move(*georeference);
  std::cout << (options.json ? to_json(summary) : to_text(summary));
  if (options.verify && !options.json) std::cout << "verified: every block\n";
  return {};
}

}  // namespace

void add_inspect_command(CLI::App& app, Status& outcome) {
  auto options = std::make_shared<InspectOptions>();
  CLI::App* command = app.add_subcommand("inspect", "Print the contents of a model file");
  command->add_option("MODEL", options->model, "Model file")->required();
  command->add_flag("--json", options->json, "Print JSON");
  command->add_flag("--verify", options->verify, "Check every checksum and decode every block");
  command->callback([options, &outcome] { outcome = inspect(*options); });
}

}  // namespace surfcast::cmd
