#include "cmd/build_progress.h"

#include <iostream>
#include <nlohmann/json.hpp>
#include <string>

#include <spdlog/fmt/fmt.h>

#include "base/json_text.h"

namespace surfcast::cmd {
namespace {

constexpr std::chrono::milliseconds kInterval{250};

std::string terminal_text(const builder::BuildOutlook& outlook) {
  const std::string text = fmt::format("{:.0f} %, {}", 100 * outlook.done, outlook.stage);
  return outlook.seconds_left > 0 ? text + fmt::format(", {:.0f} s left", outlook.seconds_left) : text;
}

std::string outlook_text(const builder::BuildOutlook& outlook) {
  return json_text(
      nlohmann::json{{"stage", outlook.stage}, {"done", outlook.done}, {"seconds_left", outlook.seconds_left}});
}

}  // namespace

BuildProgressReport::BuildProgressReport(ProgressStyle style, double points_per_second)
    : style_(style), forecast_(points_per_second) {
  if (style_ != ProgressStyle::kNone) thread_ = std::jthread([this] { report(); });
}

BuildProgressReport::~BuildProgressReport() {
  {
    const std::lock_guard lock(mutex_);
    ended_ = true;
  }
  wake_.notify_all();
  if (thread_.joinable()) thread_.join();
  if (style_ == ProgressStyle::kTerminal && !shown_.empty()) std::cerr << "\r\033[K" << std::flush;
}

void BuildProgressReport::note(const builder::BuildStep& step) {
  const std::lock_guard lock(mutex_);
  forecast_.note(step, since_.seconds());
}

void BuildProgressReport::report() {
  std::unique_lock lock(mutex_);
  while (!wake_.wait_for(lock, kInterval, [this] { return ended_; })) {
    const builder::BuildOutlook outlook = forecast_.outlook(since_.seconds());
    const std::string text = style_ == ProgressStyle::kJson ? outlook_text(outlook) : terminal_text(outlook);
    if (text == shown_) continue;
    shown_ = text;
    std::cerr << (style_ == ProgressStyle::kJson ? text + "\n" : "\r\033[K" + text) << std::flush;
  }
}

}  // namespace surfcast::cmd
