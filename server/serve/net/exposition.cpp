#include "net/exposition.h"

#include <cmath>

namespace surfcast::net {
namespace {

std::string in_braces(std::string_view label) {
  return label.empty() ? std::string() : "{" + std::string(label) + "}";
}

}  // namespace

double Histogram::bound(size_t bin) {
  return std::ldexp(0.001, static_cast<int>(bin));
}

void Histogram::add(double seconds) {
  ++count_;
  sum_ += seconds;
  for (size_t bin = 0; bin < kBins; ++bin) {
    if (seconds > bound(bin)) continue;
    ++counts_[bin];
    return;
  }
}

uint64_t Histogram::count_to(size_t bin) const {
  uint64_t count = 0;
  for (size_t i = 0; i <= bin; ++i) count += counts_[i];
  return count;
}

/// A family of OpenMetrics has the name of its counter without "_total".
void Exposition::begin(std::string_view name, std::string_view type, std::string_view help) {
  constexpr std::string_view kTotal = "_total";
  if (format_ == Format::kOpenMetrics && name.ends_with(kTotal)) name.remove_suffix(kTotal.size());
  out_ << "# HELP " << name << ' ' << help << "\n# TYPE " << name << ' ' << type << '\n';
}

void Exposition::add(std::string_view name, std::string_view label, double value) {
  out_ << name << in_braces(label) << ' ' << value << '\n';
}

void Exposition::add(std::string_view name, std::string_view label, uint64_t value) {
  out_ << name << in_braces(label) << ' ' << value << '\n';
}

void Exposition::add(std::string_view name, std::string_view label, const Histogram& histogram) {
  const std::string whole(name);
  const std::string before = label.empty() ? std::string() : std::string(label) + ",";
  for (size_t bin = 0; bin < Histogram::kBins; ++bin) {
    std::ostringstream bound;
    bound << Histogram::bound(bin);
    add(whole + "_bucket", before + "le=\"" + bound.str() + "\"", histogram.count_to(bin));
  }
  add(whole + "_bucket", before + "le=\"+Inf\"", histogram.count());
  add(whole + "_sum", label, histogram.sum());
  add(whole + "_count", label, histogram.count());
}

void Exposition::value(std::string_view name, std::string_view type, std::string_view help, uint64_t value) {
  begin(name, type, help);
  add(name, {}, value);
}

std::string Exposition::text() const {
  return out_.str() + (format_ == Format::kOpenMetrics ? "# EOF\n" : "");
}

Exposition::Format exposition_format(std::string_view accept) {
  const bool open = accept.find("application/openmetrics-text") != std::string_view::npos;
  return open ? Exposition::Format::kOpenMetrics : Exposition::Format::kPrometheus;
}

std::string_view media_type(Exposition::Format format) {
  if (format == Exposition::Format::kPrometheus) return "text/plain; version=0.0.4";
  return "application/openmetrics-text; version=1.0.0; charset=utf-8";
}

std::string label_of(std::string_view name, std::string_view text) {
  std::string label = std::string(name) + "=\"";
  for (const char c : text) {
    if (c == '\\' || c == '"') label += '\\';
    label += c == '\n' ? ' ' : c;
  }
  return label + "\"";
}

}  // namespace surfcast::net
