#include "cmd/radius_flag.h"

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

namespace surfcast::cmd {
namespace {

constexpr std::array<std::pair<std::string_view, estimation::RadiusPolicy>, 3> kPolicies = {
    {{"auto", estimation::RadiusPolicy::kAuto},
     {"keep", estimation::RadiusPolicy::kKeep},
     {"estimate", estimation::RadiusPolicy::kEstimate}}};

estimation::RadiusPolicy radius_policy(const std::string& name) {
  return std::ranges::find(kPolicies, name, [](const auto& entry) { return entry.first; })->second;
}

}  // namespace

CLI::Option* add_radius_flag(CLI::App& command, estimation::RadiusPolicy& policy) {
  return command
      .add_option_function<std::string>(
          "--radii", [&policy](const std::string& name) { policy = radius_policy(name); },
          "Radii that scans state: auto (scaled to the kernel where they follow the sampling, else estimated), keep or "
          "estimate (default auto)")
      ->check(CLI::IsMember({"auto", "keep", "estimate"}));
}

std::string name_of(estimation::RadiusPolicy policy) {
  return std::string(std::ranges::find(kPolicies, policy, [](const auto& entry) { return entry.second; })->first);
}

}  // namespace surfcast::cmd
