#include <filesystem>
#include <iostream>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <spdlog/fmt/fmt.h>

#include "base/log.h"
#include "builder/memory_budget.h"
#include "cmd/commands.h"
#include "cmd/in_place_flags.h"
#include "cmd/input_flags.h"
#include "cmd/open_members.h"
#include "cmd/store_flags.h"
#include "exporter/export_scan.h"
#include "model/joined_model.h"
#include "object_store/object_store.h"
#include "object_store/object_url.h"
#include "service/place_members.h"

namespace surfcast::cmd {
namespace {

struct ExportCommand {
  std::vector<std::filesystem::path> sources;
  std::filesystem::path output;
  std::string memory;
  exporter::ExportOptions options;
  object_store::StoreConfig store;
  InPlaceOptions in_place;
};

/// The points of a model in a store, of a scan in place, or of a file.
Result<exporter::ExportReport> export_one(const ExportCommand& command, const std::filesystem::path& source,
                                          const object_store::ObjectStore& store, const InPlaceOpener& in_place) {
  if (!object_store::is_object_url(source.string()) && !in_place.opens(source)) {
    return exporter::export_scan(source, command.output, command.options);
  }
  return open_model(source, store, in_place).and_then([&](model::ModelFile opened) {
    return exporter::export_model(std::make_shared<const model::ModelFile>(std::move(opened)), command.output,
                                  command.options);
  });
}

/// Why the points of a model cannot be written with those of the others; none if they can. Places it.
std::string why_left_out(service::MemberPlacer& placer, model::Member& member) {
  if (member.model->info().surfels == 0) return member.name + ": has no points";
  Status status = placer.place(member);
  if (status) status = model::check_place(member);
  return status ? std::string() : status.error().message;
}

/// The models whose points can be stated in one coordinate system, and notes on the others.
std::vector<model::Member> exportable(std::vector<model::Member> members, std::vector<std::string>& notes) {
  service::MemberPlacer placer;
  std::vector<model::Member> kept;
  for (model::Member& member : members) {
    if (const std::string why = why_left_out(placer, member); !why.empty()) {
      notes.push_back("left out: " + why);
      continue;
    }
    if (!member.places.empty()) {
      notes.push_back(member.name + ": brought into the system of the first model block by block, to within " +
                      fmt::format("{} of the spacing of its points", service::kMaxPlaceError));
    }
    kept.push_back(std::move(member));
  }
  return kept;
}

/// The points of several models.
Result<exporter::ExportReport> export_several(const ExportCommand& command,
                                              std::span<const std::filesystem::path> sources,
                                              const object_store::ObjectStore& store, const InPlaceOpener& in_place) {
  Result<std::vector<model::Member>> members = open_members(sources, store, in_place);
  if (!members) return fail(members);
  std::vector<std::string> notes;
  std::vector<model::Member> kept = exportable(std::move(*members), notes);
  if (kept.empty()) return fail(ErrorKind::kUnsupported, "none of the models has points that can be written");
  Result<model::ModelFile> joined = model::ModelFile::join(std::move(kept));
  if (!joined) return fail(joined);
  return exporter::export_model(std::make_shared<const model::ModelFile>(std::move(*joined)), command.output,
                                command.options)
      .map([&](exporter::ExportReport report) {
        report.notes.insert(report.notes.begin(), notes.begin(), notes.end());
        return report;
      });
}

Result<exporter::ExportReport> export_sources(const ExportCommand& command,
                                              std::span<const std::filesystem::path> sources) {
  const object_store::ObjectStore store(command.store);
  const InPlaceOpener in_place(store, command.in_place, nullptr);
  return sources.size() == 1 ? export_one(command, sources.front(), store, in_place)
                             : export_several(command, sources, store, in_place);
}

Status export_points(ExportCommand& command) {
  const Result<uint64_t> budget = builder::memory_budget(builder::parse_memory_size(command.memory));
  if (!budget) return fail(budget);
  command.options.limit = scan::DecodingLimit{*budget / 4};
  command.options.octree.memory = *budget / 2;
  const std::vector<std::filesystem::path> sources = members_of_paths(command.sources);
  const auto report = export_sources(command, sources);
  if (!report) return fail(report);
  const std::string name = sources.size() == 1 ? sources.front().string() : command.output.string();
  for (const std::string& note : report->notes) spdlog::warn("{}: {}", name, note);
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
          "SCAN", command->sources,
          "Scan: a file, or the folder of a scan in many files; or a model (.surf); or the URL of a model, or of an "
          "octree of points (COPC, EPT); or several models, whose points are written together")
      ->required();
  export_command
      ->add_option(
          "--output", command->output,
          "File to write; .las, .laz, .copc.laz, .ply, .csv or .npy at its end names the format. FOLDER/ept.json "
          "writes a new folder as EPT, FOLDER/metadata.json as Potree 2")
      ->required();
  add_selection_flags(*export_command, command->options.selection);
  export_command
      ->add_option("--scale", command->options.encoding.scale,
                   "Steps of the coordinates of LAS and LAZ, in units of the scan (default: those of the scan)")
      ->check(CLI::PositiveNumber);
  export_command
      ->add_option(
          "--chunk", command->options.encoding.chunk_size,
          "Points in a chunk of LAZ, which is decoded as a whole (default 50000); of COPC, EPT and Potree: cells with "
          "at most as many are not divided (default 12000)")
      ->check(CLI::Range(1U, 1U << 24));
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
