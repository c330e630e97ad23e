#include <filesystem>
#include <iostream>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/log.h"
#include "builder/input_files.h"
#include "cmd/commands.h"
#include "cmd/in_place_flags.h"
#include "cmd/input_summary.h"
#include "cmd/model_summary.h"
#include "cmd/open_members.h"
#include "cmd/store_flags.h"
#include "cmd/verify_model.h"
#include "model/format.h"
#include "model/model_file.h"
#include "object_store/object_store.h"
#include "object_store/object_url.h"
#include "service/place_members.h"

namespace surfcast::cmd {
namespace {

struct InspectOptions {
  std::vector<std::filesystem::path> models;
  bool json = false;
  bool verify = false;
  object_store::StoreConfig store;
  InPlaceOptions in_place;
};

/// A file that is no model may be one that a model is built of. What is neither is reported as no model.
Status inspect_input(const InspectOptions& options, const std::string& path, Error no_model) {
  if (options.verify) return fail(std::move(no_model));
  const Result<std::string> summary = summarize_input(path, options.json);
  if (!summary && builder::kind_of_input(path) == builder::InputKind::kScan) return fail(std::move(no_model));
  if (!summary) return fail(summary);
  std::cout << *summary;
  return {};
}

constexpr const char* kVerified = "verified: every block\n";

Result<ModelSummary> summary_of(const model::ModelFile& model, uint64_t bytes) {
  Result<model::Georeference> georeference = model.georeference();
  if (!georeference) return fail(georeference);
  ModelSummary summary = summarize(model, bytes);
  summary.georeference = std::move(*georeference);
  return summary;
}

/// Of a model that is open.
Result<ModelSummary> inspected(const model::ModelFile& model, const InspectOptions& options) {
  if (options.verify) {
    if (Status status = verify_model(model); !status) return fail(status);
  }
  return summary_of(model, model.source().size());
}

Status inspect_one(const InspectOptions& options, const std::string& path, const object_store::ObjectStore& store,
                   const InPlaceOpener& in_place) {
  const Result<model::ModelFile> model = open_model(path, store, in_place);
  if (!model && !object_store::is_object_url(path) && model.error().message.ends_with(model::kNoModel)) {
    return inspect_input(options, path, model.error());
  }
  if (!model) return fail(model);
  const Result<ModelSummary> summary = inspected(*model, options);
  if (!summary) return fail(summary);
  std::cout << (options.json ? to_json(*summary) : to_text(*summary));
  if (options.verify && !options.json) std::cout << kVerified;
  return {};
}

/// All of them as one model. The bytes are those of their files.
Result<ModelSummary> summarize_joined(std::vector<model::Member> members) {
  uint64_t bytes = 0;
  for (const model::Member& member : members) bytes += member.model->source().size();
  if (Status placed = service::place_members(members); !placed) return fail(placed);
  const Result<model::ModelFile> joined = model::ModelFile::join(std::move(members));
  if (!joined) return fail(joined);
  return summary_of(*joined, bytes);
}

/// Models one after another, then all of them as one.
Status inspect_several(const InspectOptions& options, std::span<const std::filesystem::path> paths,
                       const object_store::ObjectStore& store, const InPlaceOpener& in_place) {
  Result<std::vector<model::Member>> members = open_members(paths, store, in_place);
  if (!members) return fail(members);
  std::vector<ModelSummary> summaries;
  for (const model::Member& member : *members) {
    Result<ModelSummary> summary = inspected(*member.model, options);
    if (!summary) return fail(summary);
    summaries.push_back(std::move(*summary));
  }
  const Result<ModelSummary> joined = summarize_joined(std::move(*members));
  if (!joined) spdlog::warn("no totals: {}", joined.error().message);
  const ModelSummary* const totals = joined ? &*joined : nullptr;
  if (options.json) {
    std::cout << to_json(summaries, totals);
    return {};
  }
  for (const ModelSummary& summary : summaries)
    std::cout << to_text(summary) << (options.verify ? kVerified : "") << '\n';
  if (totals != nullptr) std::cout << to_text(*totals);
  return {};
}

Status inspect(const InspectOptions& options) {
  const object_store::ObjectStore store(options.store);
  const InPlaceOpener in_place(store, options.in_place, nullptr);
  const std::vector<std::filesystem::path> paths = members_of_paths(options.models);
  return paths.size() == 1 ? inspect_one(options, paths.front().string(), store, in_place)
                           : inspect_several(options, paths, store, in_place);
}

}  // namespace

void add_inspect_command(CLI::App& app, Status& outcome) {
  auto options = std::make_shared<InspectOptions>();
  CLI::App* command = app.add_subcommand("inspect", "Print the contents of a model, or of a file that one is built of");
  command
      ->add_option("MODEL", options->models,
                   "Model file or its URL, scan, volume, mesh, Gaussians or tensors; or several models, which are also "
                   "summed up as one")
      ->required();
  command->add_flag("--json", options->json, "Print JSON");
  command->add_flag("--verify", options->verify, "Check every checksum and decode every block");
  add_store_flags(*command, options->store);
  add_in_place_flags(*command, options->in_place);
  command->callback([options, &outcome] { outcome = inspect(*options); });
}

}  // namespace surfcast::cmd
