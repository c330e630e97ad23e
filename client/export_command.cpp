#include <array>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <utility>

#include "base/atomic_file.h"
#include "client/chunk_table_place.h"
#include "client/commands.h"
#include "client/server_connection.h"
#include "client/time_limits.h"
#include "protocol/errors.h"
#include "protocol/points_query.h"
#include "protocol/request_flags.h"

namespace surfcast::client {
namespace {

struct ExportCommand {
  std::string url;
  std::string box;
  std::string corridor;
  std::string classes;
  std::string every;
  std::string max_points;
  std::string coordinates;
  std::string format;
  std::string output;
  bool normals = false;
  bool count = false;
  TimeLimits limits;
};

Result<wire::PointFormat> format_of(const ExportCommand& command) {
  if (!command.format.empty()) return protocol::parse_point_format(command.format);
  if (command.count) return wire::POINT_FORMAT_CSV;
  if (command.output == "-") return fail(ErrorKind::kInvalidInput, "--output - needs --format");
  const std::string extension = std::filesystem::path(command.output).extension().string();
  if (extension.empty()) {
    return fail(ErrorKind::kInvalidInput,
                command.output + ": give it an extension (las, laz, ply, csv, npy), or --format");
  }
  if (std::filesystem::path(command.output).stem().extension() == ".copc") {
    return fail(ErrorKind::kUnsupported,
                command.output + ": servers send no COPC, surfcastd export writes it; a name without .copc gives LAZ");
  }
  return protocol::parse_point_format(std::string_view(extension).substr(1));
}

Result<wire::GetPoints> request_of(const ExportCommand& command, const std::string& model) {
  wire::GetPoints points;
  points.set_model(model);
  for (const auto& [name, text] : std::to_array<std::pair<const char*, const std::string*>>({
           {"box", &command.box},
           {"corridor", &command.corridor},
           {"classes", &command.classes},
           {"every", &command.every},
           {"max_points", &command.max_points},
           {"coordinates", &command.coordinates},
       })) {
    if (text->empty()) continue;
    if (Status status = protocol::set_points_field(points, name, *text); !status) return fail(status);
  }
  const Result<wire::PointFormat> format = format_of(command);
  if (!format) return fail(format);
  points.set_format(*format);
  points.set_normals(command.normals);
  points.set_only_count(command.count);
  if (Status status = protocol::check_points(points); !status) return fail(status);
  return points;
}

/// A file that appears when it is whole, or the standard output.
class Target {
 public:
  static Result<Target> open(const std::string& output) {
    Target target;
    if (output == "-") return target;
    Result<AtomicFile> file = AtomicFile::create(output);
    if (!file) return fail(file);
    target.file_ = std::move(*file);
    return target;
  }
  Status append(const std::string& bytes) {
    chunk_table_.add(bytes);
    if (file_) return file_->append(std::as_bytes(std::span(bytes)));
    if (std::cout.write(bytes.data(), static_cast<std::streamsize>(bytes.size()))) return {};
    return fail(ErrorKind::kIo, "cannot write to standard output");
  }
  Status finish() {
    if (file_) return finish_file();
    if (std::cout.flush()) return {};
    return fail(ErrorKind::kIo, "cannot write to standard output");
  }

 private:
  Status finish_file() {
    if (const auto correction = chunk_table_.correction()) {
      Status written = file_->overwrite(correction->offset, std::as_bytes(std::span(correction->bytes)));
      if (!written) return written;
    }
    return file_->commit();
  }

  std::optional<AtomicFile> file_;
  ChunkTablePlace chunk_table_;
};

/// The next message with the points; an answer that is an error is one here.
Result<wire::Points> next_message(ServerConnection& connection) {
  Result<wire::Answer> answer = connection.receive();
  if (!answer) return fail(answer);
  if (answer->has_error()) {
    const Error error = protocol::from_wire(answer->error());
    return connection.failed(error.kind, error.message);
  }
  if (!answer->has_points()) return connection.failed(ErrorKind::kInternal, "sent something else than points");
  return std::move(*answer->mutable_points());
}

Status receive_file(ServerConnection& connection, const ExportCommand& command) {
  Result<Target> target = Target::open(command.output);
  if (!target) return fail(target);
  for (bool more = true; more;) {
    const Result<wire::Points> piece = next_message(connection);
    if (!piece) return fail(piece);
    if (Status status = target->append(piece->data()); !status) return status;
    more = piece->more();
  }
  return target->finish();
}

Status receive(ServerConnection& connection, const ExportCommand& command) {
  const Result<wire::Points> first = next_message(connection);
  if (!first) return fail(first);
  if (command.count) {
    std::cout << first->total() << '\n';
    return {};
  }
  if (first->total() == 0) return fail(ErrorKind::kInvalidInput, command.url + ": has no points in the region");
  if (Status status = receive_file(connection, command); !status) return status;
  if (command.output != "-") std::cout << first->total() << " points\n";
  return {};
}

Status export_points(const ExportCommand& command, int interrupt) {
  const Result<protocol::ModelUrl> url = protocol::parse_model_url(command.url);
  if (!url) throw CLI::ValidationError(url.error().message);
  const Result<wire::GetPoints> points = request_of(command, url->model);
  if (!points) throw CLI::ValidationError(points.error().message);
  Result<ServerConnection> connection = ServerConnection::open(url->server, command.limits.config(*url, interrupt));
  if (!connection) return fail(connection);
  wire::Request request;
  *request.mutable_get_points() = *points;
  if (const Result<uint64_t> id = connection->send(std::move(request)); !id) return fail(id);
  return receive(*connection, command);
}

}  // namespace

void add_export_command(CLI::App& app, int interrupt, Status& outcome) {
  const auto command = std::make_shared<ExportCommand>();
  CLI::App* sub = app.add_subcommand("export", "Save the points of a model, or of a region of it");
  const auto add = [sub](const char* name, std::string& text, const char* help, const char* form) {
    return sub->add_option("--" + std::string(name), text, help)
        ->envname(protocol::environment_name(name))
        ->type_name(form);
  };
  sub->add_option("url", command->url, "HOST:PORT/MODEL or ws://HOST:PORT/MODEL")->required();
  CLI::Option* output = add("output", command->output,
                            "file of the points, by its extension las, laz, ply, csv or npy; - is standard "
                            "output",
                            "FILE");
  add("format", command->format, "format of the file", "las|laz|ply|csv|npy");
  sub->add_option(
         "--bounds,--box", command->box,
         "only points in a box, world coordinates, the lower corner first; of several boxes, points in any of them")
      ->envname(protocol::environment_name("box"))
      ->type_name("X,Y,Z,X,Y,Z;...")
      ->join(';');
  add("corridor", command->corridor,
      "only points along a line, seen from above, in a corridor of this width, with @LOW,HIGH between these heights; "
      "where y is the vertical axis, corners are Z,X",
      "WIDTH,X,Y,X,Y...;...")
      ->join(';');
  add("classes", command->classes, "only points of these classes, like 2,6", "CODE,CODE...");
  add("every", command->every, "of all points of the model only every N-th", "N");
  add("max-points", command->max_points, "more points are an error (default: the server's limit)", "COUNT");
  add("coordinates", command->coordinates,
      "source: in the system of the scan (default); world: in that of the model, where it differs", "source|world");
  sub->add_flag("--normals", command->normals, "with normals, as the model has them");
  CLI::Option* count = sub->add_flag("--count", command->count, "print how many points there are, and save nothing");
  output->excludes(count);
  command->limits.add_to(*sub);
  sub->callback([command, interrupt, &outcome] {
    if (command->output.empty() && !command->count) throw CLI::RequiredError("--output");
    outcome = export_points(*command, interrupt);
  });
}

}  // namespace surfcast::client
