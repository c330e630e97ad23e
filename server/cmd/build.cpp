#include "cmd/build.h"

#include <array>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include <spdlog/fmt/fmt.h>
#include <unistd.h>

#include "base/atomic_file.h"
#include "base/log.h"
#include "base/stopwatch.h"
#include "builder/build_model.h"
#include "builder/memory_budget.h"
#include "cmd/radius_flag.h"

namespace surfcast::cmd {
namespace {

struct BuildCommand {
  std::vector<std::filesystem::path> inputs;
  std::filesystem::path output;
  std::optional<double> precision;
  std::string up;
  std::string memory;
  scan::RadiusPolicy radii = scan::RadiusPolicy::kAuto;
  std::filesystem::path report;
};

/// One line on a terminal that is rewritten as the build goes on; silent where stderr is not a terminal.
class ProgressLine {
 public:
  ~ProgressLine() {
    if (!shown_.empty()) std::cerr << "\r\033[K" << std::flush;
  }
  void show(const builder::BuildStep& step) {
    if (!terminal_) return;
    if (step.stage != stage_ || step.done == 0) {
      stage_ = step.stage;
      since_ = {};
    }
    const std::string text = describe(step);
    if (text == shown_) return;
    shown_ = text;
    std::cerr << "\r\033[K" << text << std::flush;
  }

 private:
  /// Rate and time left are those of the stage.
  [[nodiscard]] std::string describe(const builder::BuildStep& step) const {
    if (step.done <= 0) return stage_;
    const double seconds = since_.seconds();
    std::string text = fmt::format("{} {:.0f} %", stage_, 100 * step.done);
    if (step.points > 0)
      text += fmt::format(", {:.0f} points/s", static_cast<double>(step.points) * step.done / seconds);
    return text + fmt::format(", {:.0f} s left", seconds * (1 - step.done) / step.done);
  }

  bool terminal_ = ::isatty(STDERR_FILENO) == 1;
  std::string stage_;
  Stopwatch since_;
  std::string shown_;
};

std::string figures(const builder::BuildReport& report) {
  return fmt::format("{} points read, {} surfels, {} bytes, {:.2f} s, {:.0f} points/s, {:.0f} MiB peak memory\n",
                     report.scan.points_read, report.surfels, report.bytes, report.seconds, report.points_per_second(),
                     static_cast<double>(report.peak_memory) / (1024.0 * 1024.0));
}

/// What became of the radii of each input, beside those that the notes name.
std::string radii_lines(const builder::BuildReport& report) {
  std::string lines;
  for (const auto& [input, decision] : report.radii) {
    if (decision.outcome == scan::RadiusOutcome::kEstimated) continue;
    lines += fmt::format("{}: {}\n", input, scan::describe(decision));
  }
  return lines;
}

nlohmann::ordered_json to_json(const builder::InputRadii& radii) {
  constexpr std::array kOutcomes{"kept", "scaled", "estimated"};
  const scan::RadiusDecision& decision = radii.decision;
  nlohmann::ordered_json json{{"input", radii.input},
                              {"outcome", kOutcomes.at(static_cast<size_t>(decision.outcome))},
                              {"stated", decision.stated},
                              {"missing", decision.missing}};
  if (decision.stating) {
    const auto& [median, least, most] = *decision.stating;
    json["spacings"] = {{"median", median}, {"least", least}, {"most", most}};
  }
  if (decision.outcome == scan::RadiusOutcome::kScaled) json["factor"] = decision.factor;
  return json;
}

std::string to_json(const BuildCommand& command, const builder::BuildReport& report) {
  nlohmann::ordered_json json{
      {"output", command.output.string()},
      {"points_read", report.scan.points_read},
      {"surfels", report.surfels},
      {"blocks", report.blocks},
      {"bytes", report.bytes},
      {"seconds", report.seconds},
      {"points_per_second", report.points_per_second()},
      {"memory_budget_bytes", report.memory_budget},
      {"peak_memory_bytes", report.peak_memory},
      {"parts", report.parts},
      {"stage_seconds", nlohmann::ordered_json::object()},
      {"dropped",
       {{"not_finite", report.scan.not_finite},
        {"duplicates", report.scan.duplicates},
        {"zero_normals", report.scan.zero_normals}}},
      {"estimated", {{"normals", report.scan.normals_estimated}, {"radii", report.scan.radii_estimated}}},
      {"scatter", report.scan.scatter},
      {"radii", nlohmann::ordered_json::array()},
      {"oriented", report.scan.oriented},
      {"notes", report.scan.notes},
      {"inputs", nlohmann::ordered_json::array()},
  };
  for (const auto& [stage, seconds] : report.stages) {
    nlohmann::ordered_json& total = json["stage_seconds"][stage];
    total = seconds + (total.is_number() ? total.get<double>() : 0.0);
  }
  for (const builder::InputRadii& radii : report.radii) json["radii"].push_back(to_json(radii));
  for (const std::filesystem::path& input : command.inputs) json["inputs"].push_back(input.string());
  // File names need not be UTF-8.
  return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

Status build(const BuildCommand& command) {
  Result<builder::BuildReport> report;
  {
    ProgressLine line;
    const std::optional<bool> z_up = command.up.empty() ? std::nullopt : std::optional(command.up == "z");
    const std::optional<uint64_t> memory = builder::parse_memory_size(command.memory);
    report = builder::build_model(command.inputs, command.output,
                                  {command.precision, z_up, memory, std::nullopt, command.radii},
                                  [&line](const builder::BuildStep& step) { line.show(step); });
  }
  if (!report) return fail(std::move(report.error()));
  for (const std::string& note : report->scan.notes) spdlog::warn("{}", note);
  std::cout << radii_lines(*report) << figures(*report);
  if (command.report.empty()) return {};
  return write_file_atomically(command.report, to_json(command, *report));
}

}  // namespace

void add_build_command(CLI::App& app, Status& outcome) {
  auto command = std::make_shared<BuildCommand>();
  CLI::App* build_command = app.add_subcommand("build", "Build a model file from scans");
  build_command->add_option("INPUT", command->inputs, "Scans of any supported format")->required();
  build_command->add_option("--output", command->output, "Model file to write")->required();
  build_command
      ->add_option("--precision", command->precision,
                   "Largest error of a stored position, in units of the scan (default: 1/256 of each radius)")
      ->check(CLI::PositiveNumber);
  build_command->add_option("--up", command->up, "Vertical axis: y or z (default: derived from the scan)")
      ->check(CLI::IsMember({"y", "z"}));
  build_command
      ->add_option("--memory", command->memory,
                   "Memory limit of the build, like 4G or 512M (default: a quarter of the machine's memory)")
      ->check([](const std::string& text) {
        return builder::parse_memory_size(text) ? std::string() : "not a size like 4G or 512M: " + text;
      });
  add_radius_flag(*build_command, command->radii);
  build_command->add_option("--report", command->report, "Write statistics of the build to this file as JSON");
  build_command->callback([command, &outcome] { outcome = build(*command); });
}

}  // namespace surfcast::cmd
