#include "scattered/field_options.h"

#include <array>
#include <charconv>
#include <cmath>
#include <utility>

namespace surfcast::scattered {
namespace {

constexpr std::array<std::pair<std::string_view, KernelSize>, 4> kMeanings{{
    {"radius", KernelSize::kRadius},
    {"smoothing", KernelSize::kSmoothingLength},
    {"sigma", KernelSize::kDeviation},
    {"covariance", KernelSize::kCovariance},
}};

std::optional<double> number_of(std::string_view text) {
  double number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return number;
}

}  // namespace

Result<KernelSizes> parse_kernel_sizes(std::string_view text) {
  if (text == "spacing") return KernelSizes{};
  const size_t equals = text.find('=');
  for (const auto& [name, meaning] : kMeanings) {
    if (text.substr(0, equals) != name || equals == std::string_view::npos || equals + 1 == text.size()) continue;
    const std::string_view rest = text.substr(equals + 1);
    const std::optional<double> length = number_of(rest);
    if (!length) return KernelSizes{meaning, std::string(rest), {}};
    if (!(*length > 0) || !std::isfinite(*length) || meaning == KernelSize::kCovariance) break;
    return KernelSizes{meaning, {}, length};
  }
  return fail(ErrorKind::kInvalidInput,
              "not radius=, smoothing= or sigma= with a column or a length, covariance=PREFIX or spacing: " +
                  std::string(text));
}

}  // namespace surfcast::scattered
