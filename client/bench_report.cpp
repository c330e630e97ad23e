#include "client/bench_report.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <nlohmann/json.hpp>
#include <numeric>

#include "base/json_text.h"

namespace surfcast::client {
namespace {

using nlohmann::json;

/// Stages excluded from the sum of a frame's stages: those contained in `load`, and those of the previous frame.
bool is_no_part_of_sum(const std::string& stage) {
  return stage == "decode" || stage == "upload" || stage == "transfer" || stage == "paint";
}

double time_in_stages(const BenchFrame& frame) {
  double sum = 0;
  for (const auto& [name, milliseconds] : frame.stages) sum += is_no_part_of_sum(name) ? 0 : milliseconds;
  return sum;
}

std::vector<BenchFrame> moving_frames(const BenchRecord& record) {
  std::vector<BenchFrame> frames;
  std::ranges::copy_if(record.frames, std::back_inserter(frames), &BenchFrame::moving);
  return frames;
}

/// Percentiles of `figure` over the frames of every run from share `from` to share `to` of the run.
Percentiles over(const std::vector<std::vector<BenchFrame>>& runs, double from, double to,
                 const std::function<double(const BenchFrame&)>& figure) {
  std::vector<double> values;
  for (const std::vector<BenchFrame>& run : runs) {
    const auto count = static_cast<double>(run.size());
    const auto begin = static_cast<size_t>(count * from);
    const auto end = static_cast<size_t>(count * to);
    for (size_t i = begin; i < end; ++i) values.push_back(figure(run[i]));
  }
  return percentiles(std::move(values));
}

std::map<std::string, Percentiles> stages_of(const std::vector<std::vector<BenchFrame>>& runs) {
  std::map<std::string, std::vector<double>> times;
  for (const std::vector<BenchFrame>& run : runs) {
    for (const BenchFrame& frame : run) {
      for (const auto& [name, milliseconds] : frame.stages) times[name].push_back(milliseconds);
    }
  }
  std::map<std::string, Percentiles> stages;
  for (auto& [name, values] : times) stages[name] = percentiles(std::move(values));
  return stages;
}

void add_rests(const std::vector<BenchRecord>& records, BenchReport& report) {
  std::vector<double> times;
  std::vector<double> bytes;
  std::vector<BenchFrame> frames;
  for (const BenchRecord& record : records) {
    for (const BenchFrame& frame : record.frames) {
      if (!frame.converged) continue;
      frames.push_back(frame);
      times.push_back(frame.latency_ms);
      bytes.push_back(static_cast<double>(frame.bytes));
    }
  }
  report.converged = percentiles(std::move(times));
  report.rest_bytes = percentiles(std::move(bytes));
  report.rest_stages = stages_of({frames});
}

void add_counts(const BenchRecord& record, BenchReport& report) {
  report.updates += record.updates;
  report.abandoned += record.abandoned;
  report.unconverged += record.unconverged;
  report.late += record.late;
  report.bytes += record.bytes;
}

json to_json(const Percentiles& values) {
  return {{"count", values.count}, {"mean", values.mean}, {"p50", values.p50},
          {"p95", values.p95},     {"p99", values.p99},   {"max", values.most}};
}

json to_json(const std::map<std::string, Percentiles>& stages) {
  json object = json::object();
  for (const auto& [name, values] : stages) object[name] = to_json(values);
  return object;
}

std::string line(const std::string& name, const Percentiles& values) {
  std::array<char, 160> text{};
  std::snprintf(text.data(), text.size(), "%-24s %9.1f %9.1f %9.1f %9.1f\n", name.c_str(), values.p50, values.p95,
                values.p99, values.most);
  return text.data();
}

}  // namespace

Percentiles percentiles(std::vector<double> values) {
  if (values.empty()) return {};
  std::ranges::sort(values);
  const auto count = static_cast<double>(values.size());
  const auto rank = [&](double part) {
    return values[static_cast<size_t>(std::max(1.0, std::ceil(part * count))) - 1];
  };
  return {.count = values.size(),
          .mean = std::reduce(values.begin(), values.end()) / count,
          .p50 = rank(0.5),
          .p95 = rank(0.95),
          .p99 = rank(0.99),
          .most = values.back()};
}

BenchReport make_report(const std::vector<BenchRecord>& records) {
  BenchReport report;
  report.clients = records.size();
  std::vector<std::vector<BenchFrame>> runs;
  std::vector<double> rates;
  for (const BenchRecord& record : records) {
    runs.push_back(moving_frames(record));
    report.moving_frames += runs.back().size();
    report.video_frames += static_cast<uint64_t>(std::ranges::count(runs.back(), true, &BenchFrame::video));
    if (record.moving_seconds > 0) rates.push_back(static_cast<double>(runs.back().size()) / record.moving_seconds);
    add_counts(record, report);
  }
  const auto latency = [](const BenchFrame& frame) { return frame.latency_ms; };
  report.frames_per_second = percentiles(std::move(rates));
  report.latency = over(runs, 0, 1, latency);
  report.latency_begin = over(runs, 0, 1.0 / 3, latency);
  report.latency_end = over(runs, 2.0 / 3, 1, latency);
  report.outside = over(runs, 0, 1, [](const auto& frame) { return frame.latency_ms - time_in_stages(frame); });
  report.turned = over(runs, 0, 1, [](const auto& frame) { return frame.turned; });
  report.depth_bytes = over(runs, 0, 1, [](const auto& frame) { return static_cast<double>(frame.depth_bytes); });
  report.moving_bytes = over(runs, 0, 1, [](const auto& frame) { return static_cast<double>(frame.bytes); });
  report.moving_width = over(runs, 0, 1, [](const auto& frame) { return static_cast<double>(frame.width); });
  report.moving_spacing = over(runs, 0, 1, [](const auto& frame) { return frame.spacing; });
  report.moving_stages = stages_of(runs);
  add_rests(records, report);
  return report;
}

std::string to_text(const BenchReport& report) {
  std::string text = std::to_string(report.clients) + (report.clients == 1 ? " client" : " clients") + "\n" +
                     "                               p50       p95       p99       max\n";
  text += line("frames/s while moving", report.frames_per_second);
  text += line("motion latency, ms", report.latency);
  for (const auto& [name, values] : report.moving_stages) text += line("  " + name, values);
  text += line("  outside all stages", report.outside);
  text += line("turned since, degrees", report.turned);
  text += line("bytes of a moving frame", report.moving_bytes);
  if (report.depth_bytes.most > 0) text += line("  of its depth", report.depth_bytes);
  text += line("width of it, pixels", report.moving_width);
  text += line("spacing of it, pixels", report.moving_spacing);
  text += line("time to converged, ms", report.converged);
  for (const auto& [name, values] : report.rest_stages) text += line("  " + name, values);
  text += line("bytes of that frame", report.rest_bytes);
  text += std::to_string(report.updates) + " cameras, " + std::to_string(report.moving_frames) + " moving frames, " +
          (report.video_frames > 0 ? std::to_string(report.video_frames) + " of them of a video, " : std::string()) +
          std::to_string(report.abandoned) + " given up on the way; " + std::to_string(report.converged.count) +
          " rests converged, " + std::to_string(report.unconverged) + " did not; " + std::to_string(report.bytes) +
          " bytes\n";
  return text;
}

std::string to_json(const BenchReport& report, const std::string& url) {
  const json document{{"url", url},
                      {"clients", report.clients},
                      {"bytes", report.bytes},
                      {"moving",
                       {{"frames_per_second", to_json(report.frames_per_second)},
                        {"latency_ms", to_json(report.latency)},
                        {"latency_ms_first_third", to_json(report.latency_begin)},
                        {"latency_ms_last_third", to_json(report.latency_end)},
                        {"stages_ms", to_json(report.moving_stages)},
                        {"outside_ms", to_json(report.outside)},
                        {"turned_degrees", to_json(report.turned)},
                        {"depth_bytes", to_json(report.depth_bytes)},
                        {"video_frames", report.video_frames},
                        {"bytes", to_json(report.moving_bytes)},
                        {"width", to_json(report.moving_width)},
                        {"spacing", to_json(report.moving_spacing)},
                        {"cameras", report.updates},
                        {"frames", report.moving_frames},
                        {"abandoned", report.abandoned}}},
                      {"rest",
                       {{"converged_ms", to_json(report.converged)},
                        {"stages_ms", to_json(report.rest_stages)},
                        {"bytes", to_json(report.rest_bytes)},
                        {"unconverged", report.unconverged},
                        {"frames_after_converged", report.late}}}};
  return json_text(document, 2) + "\n";
}

}  // namespace surfcast::client
