#include <filesystem>
#include <iostream>
#include <memory>
#include <string>

#include <spdlog/fmt/fmt.h>

#include "base/log.h"
#include "builder/memory_budget.h"
#include "cmd/commands.h"
#include "cmd/in_place_flags.h"
#include "cmd/selection_flags.h"
#include "cmd/store_flags.h"
#include "exporter/export_scan.h"
#include "object_store/object_store.h"
#include "object_store/object_url.h"

namespace surfcast::cmd {
namespace {

struct ExportCommand {
  std::filesystem::path source;
  std::filesystem::path output;
  std::string memory;
  exporter::ExportOptions options;
  object_store::StoreConfig store;
  InPlaceOptions in_place;
};

/// The points of a model in a store, of a scan in place, or of a file.
Result<exporter::ExportReport> export_source(const ExportCommand& command) {
  const std::string source = command.source.string();
  const object_store::ObjectStore store(command.store);
  const InPlaceOpener in_place(store, command.in_place, nullptr);
  const bool stored = object_store::is_object_url(source);
  if (!stored && !in_place.opens(command.source)) {
    return exporter::export_scan(command.source, command.output, command.options);
  }
  const std::string shown = stored ? object_store::shown_url(source) : source;
  Result<model::ModelFile> model =
      in_place.opens(command.source) ? in_place.open(command.source, shown) : store.open(source, shown);
  return std::move(model).and_then([&](model::ModelFile opened) {
    return exporter::export_model(std::make_shared<const model::ModelFile>(std::move(opened)), command.output,
                                  command.options);
  });
}

Status export_points(ExportCommand& command) {
  const Result<uint64_t> budget = builder::memory_budget(builder::parse_memory_size(command.memory));
  if (!budget) return fail(budget.error());
  command.options.limit = scan::DecodingLimit{*budget / 4};
  command.options.octree.memory = *budget / 2;
  const auto report = export_source(command);
  if (!report) return fail(report.error());
  for (const std::string& note : report->notes) spdlog::warn("{}: {}", command.source.string(), note);
  std::cout << fmt::format("{} points, {} bytes\n", report->points, report->bytes);
  return {};
}

}  // namespace

void add_export_command(CLI::App& app, Status& outcome) {
  auto command = std::make_shared<ExportCommand>();
  CLI::App* export_command =
      app.add_subcommand("export", "Write the points of a scan or model, or a part of them, into a file");
  export_command
      ->add_option(
          "SCAN", command->source,
          "Scan: a file, or the folder of a scan in many files; or a model (.surf); or the URL of a model, or of an "
          "octree of points (COPC, EPT)")
      ->required();
  export_command
      ->add_option(
          "--output", command->output,
          "File to write; .las, .laz, .copc.laz, .ply, .csv or .npy at its end names the format. FOLDER/ept.json "
          "writes a new folder as EPT")
      ->required();
  add_selection_flags(*export_command, command->options.selection);
  export_command
      ->add_option("--scale", command->options.encoding.scale,
                   "Steps of the coordinates of LAS and LAZ, in units of the scan (default: those of the scan)")
      ->check(CLI::PositiveNumber);
  export_command
      ->add_option(
          "--chunk", command->options.encoding.chunk_size,
          "Points in a chunk of LAZ, which is decoded as a whole; of COPC and EPT: cells with at most as many are "
          "not divided")
      ->check(CLI::Range(1U, 1U << 24))
      ->capture_default_str();
  export_command
      ->add_option("--memory", command->memory,
                   "Memory limit, like 4G or 512M (default: a quarter of the machine's memory)")
      ->check([](const std::string& text) {
        return builder::parse_memory_size(text) ? std::string() : "not a size like 4G or 512M: " + text;
      });
  add_store_flags(*export_command, command->store);
  add_in_place_flags(*export_command, command->in_place);
  export_command->callback([command, &outcome] { outcome = export_points(*command); });
}

}  // namespace surfcast::cmd
