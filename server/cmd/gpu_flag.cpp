#include "cmd/gpu_flag.h"

#include <atomic>
#include <charconv>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "base/child_process.h"
#include "cmd/commands.h"
#include "cmd/worker_role.h"
#include "protocol/request_flags.h"

namespace surfcast::cmd {
namespace {

constexpr int kMaxDevice = 63;
constexpr size_t kMaxDevices = 64;
constexpr const char* kForm = "must be all, or numbers of EGL devices from 0 to 63 with commas between them";

std::optional<int> device_number(std::string_view text) {
  int number = 0;
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), number);
  const bool whole = code == std::errc() && end == text.data() + text.size();
  return whole && number >= 0 && number <= kMaxDevice ? std::optional(number) : std::nullopt;
}

std::optional<GpuSelection> parse_gpus(std::string_view text) {
  if (text == "all") return GpuSelection{true, {}};
  GpuSelection gpus;
  for (;;) {
    const size_t comma = text.find(',');
    const std::optional<int> number = device_number(text.substr(0, comma));
    if (!number || gpus.numbers.size() == kMaxDevices) return std::nullopt;
    gpus.numbers.push_back(*number);
    if (comma == std::string_view::npos) return gpus;
    text.remove_prefix(comma + 1);
  }
}

/// The number at the beginning of a line of the command `gpus`, if it is one of hardware.
std::optional<int> hardware_device(std::string_view line) {
  const size_t space = line.find(' ');
  if (space == std::string_view::npos || !line.substr(space + 1).starts_with(kHardwareDevice)) return std::nullopt;
  return device_number(line.substr(0, space));
}

}  // namespace

void add_gpus_flag(CLI::App& command, GpuSelection& gpus, const std::string& use) {
  command
      .add_option_function<std::string>(
          "--gpu", [&gpus](const std::string& text) { gpus = parse_gpus(text).value_or(GpuSelection()); },
          "EGL device to draw on, or several with commas between them, or all: " + use +
              " (default: the first hardware device; the command gpus lists the devices)")
      ->envname(protocol::environment_name("gpu"))
      ->type_name("N,...|all")
      ->check([](const std::string& text) { return parse_gpus(text) ? std::string() : kForm; });
}

Result<std::vector<int>> devices_of(const GpuSelection& gpus) {
  constexpr int kDefault = -1;
  if (!gpus.all) return gpus.numbers.empty() ? std::vector{kDefault} : gpus.numbers;
  Result<std::vector<std::string>> command = worker_command(kGpusCommand);
  if (!command) return fail(command);
  std::vector<int> numbers;
  const std::atomic<bool> never{false};
  const Result<int> ended = run_child(
      *command,
      [&numbers](std::string_view line) {
        if (const std::optional<int> number = hardware_device(line)) numbers.push_back(*number);
      },
      never);
  if (!ended) return fail(ended);
  return numbers.empty() ? std::vector{kDefault} : numbers;
}

}  // namespace surfcast::cmd
