#include "builder/build_steps.h"

#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <oneapi/tbb/global_control.h>
#include <spdlog/fmt/fmt.h>

#include "base/log.h"
#include "base/stopwatch.h"
#include "builder/memory_budget.h"
#include "cmd/build_flags.h"
#include "cmd/commands.h"
#include "cmd/input_flags.h"

namespace surfcast::cmd {
namespace {

/// A step of a build in parts. Each command has some of these.
struct StepCommand {
  std::vector<std::filesystem::path> inputs;
  std::filesystem::path work;
  std::filesystem::path output;
  size_t part = 0;
  ModelFlags model;
  builder::PlanRequest request;
  RunFlags run;

  [[nodiscard]] builder::WorkPlace place() const { return {work, SURFCAST_VERSION}; }
};

/// Runs a step with its progress, on its threads.
template <typename Step>
auto run_step(const StepCommand& command, const Step& step) {
  keep_freed_memory();
  std::optional<oneapi::tbb::global_control> threads;
  if (command.run.threads > 0) {
    threads.emplace(oneapi::tbb::global_control::max_allowed_parallelism, command.run.threads);
  }
  BuildProgressReport progress(command.run.style(), command.run.points_per_second());
  return step([&progress](const builder::BuildStep& now) { progress.note(now); });
}

void warn_of(const std::vector<std::string>& notes) {
  for (const std::string& note : notes) spdlog::warn("{}", note);
}

Status plan(StepCommand& command) {
  if (Status status = open_folders(command.inputs); !status) return status;
  const Result<uint64_t> memory = builder::memory_budget(builder::parse_memory_size(command.model.memory));
  if (!memory) return fail(memory);
  builder::PlanRequest& request = command.request;
  request.program = SURFCAST_VERSION;
  request.precision = command.model.precision;
  request.z_up = command.model.z_up();
  request.memory = *memory;
  const auto planned = run_step(command, [&](const builder::BuildProgress& progress) {
    return builder::plan_build(command.inputs, command.work, request, progress);
  });
  if (!planned) return fail(planned);
  warn_of(planned->notes);
  std::cout << system_lines(planned->transformed, planned->georeference)
            << fmt::format("{}{} points of {} inputs, {} parts of {} points at most\n",
                           planned->done_before ? "planned before: " : "", planned->points, planned->inputs,
                           planned->parts, planned->largest_part);
  return {};
}

Status make_part(const StepCommand& command) {
  const auto made = run_step(command, [&](const builder::BuildProgress& progress) {
    return builder::build_part(command.place(), command.part, progress);
  });
  if (!made) return fail(made);
  std::cout << (made->done_before
                    ? fmt::format("part {} was made before\n", command.part)
                    : fmt::format("part {}: {} surfels, and {} around them\n", command.part, made->own, made->halo));
  return {};
}

Status decide_signs(const StepCommand& command) {
  const auto signs = run_step(
      command, [&](const builder::BuildProgress& progress) { return builder::build_signs(command.place(), progress); });
  if (!signs) return fail(signs);
  warn_of(signs->notes);
  for (const auto& [input, decision] : signs->radii) {
    if (decision.outcome == estimation::RadiusOutcome::kEstimated) continue;
    std::cout << fmt::format("{}: {}\n", input, estimation::describe(decision));
  }
  std::cout << (signs->done_before ? "signs were resolved before\n"
                : signs->oriented  ? "surfaces have a front and a back\n"
                                   : "surfaces are seen from both sides\n");
  return {};
}

Status make_blocks(const StepCommand& command) {
  const auto made = run_step(command, [&](const builder::BuildProgress& progress) {
    return builder::build_part_blocks(command.place(), command.part, progress);
  });
  if (!made) return fail(made);
  std::cout << (made->done_before
                    ? fmt::format("blocks of part {} were made before\n", command.part)
                    : fmt::format("part {}: {} surfels in {} blocks\n", command.part, made->surfels, made->blocks));
  return {};
}

Status merge(const StepCommand& command) {
  const Stopwatch stopwatch;
  const auto merged = run_step(command, [&](const builder::BuildProgress& progress) {
    return builder::merge_parts(command.place(), command.output, progress);
  });
  if (!merged) return fail(merged);
  std::cout << (merged->done_before
                    ? fmt::format("{} was merged before\n", command.output.string())
                    : fmt::format("{} points read, {} surfels, {} blocks, {} bytes, {:.2f} s\n", merged->points_read,
                                  merged->surfels, merged->blocks, merged->bytes, stopwatch.seconds()));
  return {};
}

/// A command with the flags that all steps have.
CLI::App& add_step(CLI::App& app, StepCommand& command, const std::string& name, const std::string& help) {
  CLI::App* step = app.add_subcommand(name, help);
  step->add_option("--work", command.work, "Folder of the plan and of what the steps make; all machines share it")
      ->required();
  add_run_flags(*step, command.run);
  return *step;
}

void add_part_number(CLI::App& step, StepCommand& command) {
  step.add_option("K", command.part, "Number of the part, from 1 on")->required();
}

void add_plan_command(CLI::App& app, Status& outcome) {
  auto command = std::make_shared<StepCommand>();
  CLI::App& step = add_step(app, *command, "build-plan", "First step of a build in parts: divide scans into parts");
  step.add_option("INPUT", command->inputs, "Scans, or folders of them")->required();
  step.add_option("--parts", command->request.parts, "Number of parts (default: as the memory allows)")
      ->check(CLI::PositiveNumber);
  add_model_flags(step, command->model);
  add_radius_flag(step, command->request.radii);
  add_selection_flags(step, command->request.selection);
  add_system_flags(step, command->request.systems);
  step.callback([command, &outcome] { outcome = plan(*command); });
}

}  // namespace

void add_build_step_commands(CLI::App& app, Status& outcome) {
  add_plan_command(app, outcome);
  const auto part = std::make_shared<StepCommand>();
  CLI::App& part_step = add_step(app, *part, "build-part", "Step of a build in parts: make the surfels of a part");
  add_part_number(part_step, *part);
  part_step.callback([part, &outcome] { outcome = make_part(*part); });
  const auto signs = std::make_shared<StepCommand>();
  add_step(app, *signs, "build-signs", "Step of a build in parts, after all parts: resolve what they share")
      .callback([signs, &outcome] { outcome = decide_signs(*signs); });
  const auto blocks = std::make_shared<StepCommand>();
  CLI::App& blocks_step =
      add_step(app, *blocks, "build-blocks", "Step of a build in parts, after build-signs: make the blocks of a part");
  add_part_number(blocks_step, *blocks);
  blocks_step.callback([blocks, &outcome] { outcome = make_blocks(*blocks); });
  const auto merged = std::make_shared<StepCommand>();
  CLI::App& merge_step =
      add_step(app, *merged, "build-merge", "Last step of a build in parts, after all blocks: write the model");
  merge_step.add_option("--output", merged->output, "Model file to write")->required();
  merge_step.callback([merged, &outcome] { outcome = merge(*merged); });
}

}  // namespace surfcast::cmd
