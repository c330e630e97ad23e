#include "cmd/radius_flag.h"

#include <map>
#include <string>

namespace surfcast::cmd {

CLI::Option* add_radius_flag(CLI::App& command, scan::RadiusPolicy& policy) {
  static const std::map<std::string, scan::RadiusPolicy> kPolicies{{"auto", scan::RadiusPolicy::kAuto},
                                                                   {"keep", scan::RadiusPolicy::kKeep},
                                                                   {"estimate", scan::RadiusPolicy::kEstimate}};
  return command
      .add_option_function<std::string>(
          "--radii", [&policy](const std::string& name) { policy = kPolicies.at(name); },
          "Radii that scans state: auto (scaled to the kernel where they follow the sampling, else estimated), keep or "
          "estimate (default auto)")
      ->check(CLI::IsMember({"auto", "keep", "estimate"}));
}

}  // namespace surfcast::cmd
