#include <cmath>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "base/json_text.h"
#include "client/commands.h"
#include "client/time_limits.h"

namespace surfcast::client {
namespace {

struct ModelsCommand {
  std::string url;
  bool json = false;
  TimeLimits limits;
};

Result<wire::ModelList> ask_for_models(const protocol::Endpoint& server, const ClientConfig& config) {
  wire::Request request;
  request.mutable_list_models();
  return ask_server(server, config, std::move(request)).map([](wire::Answer answer) {
    return std::move(*answer.mutable_model_list());
  });
}

const char* name_of(wire::ScanState state) {
  switch (state) {
    case wire::SCAN_STATE_WAITING:
      return "waiting";
    case wire::SCAN_STATE_BUILDING:
      return "building";
    default:
      break;
  }
  return "failed";
}

/// As /api/models states it.
nlohmann::json to_json(const wire::ScanStatus& scan) {
  nlohmann::json json{{"model", scan.model()}, {"state", name_of(scan.state())}, {"preview", scan.edition() > 0}};
  if (scan.state() == wire::SCAN_STATE_FAILED) {
    json["problem"] = scan.problem();
    return json;
  }
  json["percent"] = std::floor(1000 * scan.done()) / 10;
  json["seconds_left"] = scan.seconds_left() > 0 ? nlohmann::json(std::ceil(scan.seconds_left())) : nlohmann::json();
  return json;
}

nlohmann::json to_json(const wire::ModelList& list) {
  nlohmann::json scans = nlohmann::json::array();
  for (const wire::ScanStatus& scan : list.scans()) scans.push_back(to_json(scan));
  return {{"models", std::vector<std::string>(list.models().begin(), list.models().end())}, {"scans", scans}};
}

Status list_models(const ModelsCommand& command, int interrupt) {
  const Result<protocol::Endpoint> server = protocol::parse_endpoint(command.url);
  if (!server) throw CLI::ValidationError(server.error().message);
  const Result<wire::ModelList> list = ask_for_models(*server, command.limits.config(*server, interrupt));
  if (!list) return fail(list);
  if (command.json) {
    std::cout << json_text(to_json(*list), 2) << '\n';
  } else {
    for (const std::string& name : list->models()) std::cout << name << '\n';
  }
  if (!std::cout.flush()) return fail(ErrorKind::kIo, "cannot write to standard output");
  return {};
}

}  // namespace

void add_models_command(CLI::App& app, int interrupt, Status& outcome) {
  const auto command = std::make_shared<ModelsCommand>();
  CLI::App* sub = app.add_subcommand("models", "List the models of a server");
  sub->add_option("url", command->url, "HOST:PORT or ws://HOST:PORT; with TLS tcps:// or wss://")->required();
  sub->add_flag("--json", command->json, "print JSON");
  command->limits.add_to(*sub);
  sub->callback([command, interrupt, &outcome] { outcome = list_models(*command, interrupt); });
}

}  // namespace surfcast::client
