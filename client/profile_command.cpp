#include <filesystem>
#include <iostream>
#include <memory>

#include "base/atomic_file.h"
#include "client/commands.h"
#include "client/time_limits.h"
#include "protocol/profile_file.h"
#include "protocol/request_flags.h"

namespace surfcast::client {
namespace {

struct ProfileCommand {
  std::string url;
  std::string line;
  std::string width;
  std::string max_points;
  std::string output;
  std::string format;
  TimeLimits limits;
};

Result<protocol::ProfileFormat> format_of(const ProfileCommand& command) {
  if (!command.format.empty()) return protocol::parse_profile_format(command.format);
  if (command.output == "-") return fail(ErrorKind::kInvalidInput, "--output - needs --format");
  const std::string extension = std::filesystem::path(command.output).extension().string();
  if (extension.empty()) {
    return fail(ErrorKind::kInvalidInput, command.output + ": give it an extension (csv, las), or --format");
  }
  return protocol::parse_profile_format(extension.substr(1));
}

Result<wire::GetProfile> request_of(const ProfileCommand& command, const std::string& model) {
  wire::GetProfile profile;
  profile.set_model(model);
  for (const auto& [name, text] : {std::pair("line", &command.line), std::pair("width", &command.width),
                                   std::pair("max_points", &command.max_points)}) {
    if (text->empty()) continue;
    if (Status status = protocol::set_profile_field(profile, name, *text); !status) return fail(status);
  }
  if (Status status = protocol::check_profile(profile); !status) return fail(status);
  return profile;
}

Status write(const std::string& content, const std::string& output) {
  if (output != "-") return write_file_atomically(output, std::string_view(content));
  if (std::cout.write(content.data(), static_cast<std::streamsize>(content.size())).flush()) return {};
  return fail(ErrorKind::kIo, "cannot write to standard output");
}

Status save(const ProfileCommand& command, const wire::Profile& profile, protocol::ProfileFormat format) {
  if (Status status = protocol::check_profile_answer(profile); !status) return status;
  const auto count = static_cast<uint64_t>(profile.x_size());
  if (count < profile.total()) {
    std::cerr << "surfcast: an even sample: " << count << " of " << profile.total() << " points\n";
  }
  return write(protocol::profile_file(profile, format), command.output);
}

Status fetch_profile(const ProfileCommand& command, int interrupt) {
  const Result<protocol::ModelUrl> url = protocol::parse_model_url(command.url);
  if (!url) throw CLI::ValidationError(url.error().message);
  const Result<protocol::ProfileFormat> format = format_of(command);
  if (!format) throw CLI::ValidationError(format.error().message);
  const Result<wire::GetProfile> profile = request_of(command, url->model);
  if (!profile) throw CLI::ValidationError(profile.error().message);
  wire::Request request;
  *request.mutable_get_profile() = *profile;
  return ask_server(url->server, command.limits.config(*url, interrupt), std::move(request))
      .and_then([&](const wire::Answer& answer) { return save(command, answer.profile(), *format); });
}

}  // namespace

void add_profile_command(CLI::App& app, int interrupt, Status& outcome) {
  const auto command = std::make_shared<ProfileCommand>();
  CLI::App* sub = app.add_subcommand("profile", "Save the points of a model in a band along a line");
  const auto add = [sub](const char* name, std::string& text, const char* help, const char* form) {
    return sub->add_option("--" + std::string(name), text, help)
        ->envname(protocol::environment_name(name))
        ->type_name(form);
  };
  sub->add_option("url", command->url, "HOST:PORT/MODEL or ws://HOST:PORT/MODEL")->required();
  add("line", command->line, "2 to 1024 points of the line, world coordinates; the vertical one has no meaning",
      "X,Y,Z;X,Y,Z;...")
      ->required()
      ->join(';');
  add("width", command->width, "horizontal width of the band, world units", "WIDTH")->required();
  add("output", command->output, "file of the points, by its extension csv or las; - is standard output", "FILE")
      ->required();
  add("format", command->format, "format of the file", "csv|las");
  add("max-points", command->max_points,
      "an even sample of so many points at most (default: the server's limit, a million unless it was told otherwise)",
      "COUNT");
  command->limits.add_to(*sub);
  sub->callback([command, interrupt, &outcome] { outcome = fetch_profile(*command, interrupt); });
}

}  // namespace surfcast::client
