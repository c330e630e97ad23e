#include "net/annotations.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <fstream>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <span>
#include <system_error>
#include <utility>

#include "base/atomic_file.h"
#include "base/hash.h"
#include "base/json_text.h"

namespace surfcast::net {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

constexpr const char* kFormat = "surfcast-annotations";
constexpr int kVersion = 1;

tl::unexpected<Error> wrong(const std::string& what) {
  return fail(ErrorKind::kInvalidInput, what);
}

/// Fails unless the object has these members and no others.
Status check_members(const ordered_json& object, std::initializer_list<std::string_view> names,
                     const std::string& where) {
  if (!object.is_object()) return wrong(where + " is not an object");
  for (const auto& [name, value] : object.items()) {
    if (std::ranges::find(names, name) != names.end()) continue;
    std::string problem = where;
    return wrong(problem.append(" has an unknown member '").append(name).append("'"));
  }
  return {};
}

Result<std::string> text_in(const ordered_json& object, const char* name, size_t most, const std::string& where) {
  const auto found = object.find(name);
  if (found == object.end() || !found->is_string()) return wrong(where + " has no " + name);
  std::string text = found->get<std::string>();
  if (text.empty() || text.size() > most) {
    return wrong(where + ": " + name + " must have 1 to " + std::to_string(most) + " bytes");
  }
  return text;
}

/// The parameters of a link to a view: names and values as in the address of the viewer.
Result<ordered_json> parameters_in(const ordered_json& object, const std::string& where) {
  const auto found = object.find("parameters");
  if (found == object.end() || !found->is_object()) return wrong(where + " has no parameters");
  if (found->size() > kMaxViewParameters) return wrong(where + " has too many parameters");
  for (const auto& [name, value] : found->items()) {
    if (!value.is_string() || name.size() + value.get_ref<const std::string&>().size() > kMaxViewParameterBytes) {
      return wrong(where + ": parameters are short texts");
    }
  }
  return *found;
}

Result<ordered_json> position_in(const ordered_json& object, const std::string& where) {
  const auto found = object.find("position");
  const bool valid = found != object.end() && found->is_array() && found->size() == 3 &&
                     std::ranges::all_of(*found, [](const ordered_json& coordinate) {
                       return coordinate.is_number() && std::isfinite(coordinate.get<double>());
                     });
  if (!valid) return wrong(where + ": position must be three finite numbers");
  return *found;
}

Result<ordered_json> saved_view_of(const ordered_json& entry, const std::string& where) {
  if (Status status = check_members(entry, {"name", "parameters"}, where); !status) return fail(status);
  Result<std::string> name = text_in(entry, "name", kMaxViewNameBytes, where);
  if (!name) return fail(name);
  Result<ordered_json> parameters = parameters_in(entry, where);
  if (!parameters) return fail(parameters);
  return ordered_json{{"name", std::move(*name)}, {"parameters", std::move(*parameters)}};
}

Result<ordered_json> annotation_of(const ordered_json& entry, const std::string& where) {
  if (Status status = check_members(entry, {"text", "position", "parameters"}, where); !status) {
    return fail(status);
  }
  Result<std::string> text = text_in(entry, "text", kMaxAnnotationTextBytes, where);
  if (!text) return fail(text);
  Result<ordered_json> position = position_in(entry, where);
  if (!position) return fail(position);
  Result<ordered_json> parameters = parameters_in(entry, where);
  if (!parameters) return fail(parameters);
  return ordered_json{
      {"text", std::move(*text)}, {"position", std::move(*position)}, {"parameters", std::move(*parameters)}};
}

using Normalize = Result<ordered_json> (*)(const ordered_json& entry, const std::string& where);

/// The entries of a list, which may be absent.
Result<ordered_json> entries_of(const ordered_json& document, const char* list, const std::string& entry_name,
                                Normalize normalize) {
  ordered_json entries = ordered_json::array();
  const auto found = document.find(list);
  if (found == document.end()) return entries;
  if (!found->is_array()) return wrong(std::string(list) + " is not a list");
  for (size_t i = 0; i < found->size(); ++i) {
    Result<ordered_json> entry = normalize((*found)[i], entry_name + ' ' + std::to_string(i + 1));
    if (!entry) return fail(entry);
    entries.push_back(std::move(*entry));
  }
  return entries;
}

std::string text_of(ordered_json views, ordered_json annotations, const std::string& model) {
  const ordered_json document{{"format", kFormat},
                              {"version", kVersion},
                              {"model", model},
                              {"views", std::move(views)},
                              {"annotations", std::move(annotations)}};
  return json_text(document, 2) + "\n";
}

Annotations with_edition(std::string document) {
  std::string edition = hash_name(std::as_bytes(std::span(document)));
  return {std::move(document), std::move(edition)};
}

/// The content of a file, as far as it may be long.
Result<std::string> content_of(const fs::path& file, size_t most, const std::string& model) {
  std::ifstream stream(file, std::ios::binary);
  std::string content(most + 1, '\0');
  stream.read(content.data(), static_cast<std::streamsize>(content.size()));
  if (!stream.is_open() || stream.bad()) return fail(ErrorKind::kIo, "the annotations of " + model + " cannot be read");
  content.resize(static_cast<size_t>(stream.gcount()));
  return content;
}

}  // namespace

Result<std::string> normalized_annotations(std::string_view document, const std::string& model) {
  const ordered_json parsed = parse_ordered_json_text(document);
  if (parsed.is_discarded()) return wrong("the annotations are not JSON");
  if (Status status =
          check_members(parsed, {"format", "version", "model", "views", "annotations"}, "the document of annotations");
      !status) {
    return fail(status);
  }
  if (parsed.value("format", ordered_json()) != kFormat) return wrong("the format is not \"surfcast-annotations\"");
  if (parsed.value("version", ordered_json()) != kVersion)
    return wrong("the annotations are of another version of Surfcast");
  Result<ordered_json> views = entries_of(parsed, "views", "view", saved_view_of);
  if (!views) return fail(views);
  Result<ordered_json> annotations = entries_of(parsed, "annotations", "annotation", annotation_of);
  if (!annotations) return fail(annotations);
  return text_of(std::move(*views), std::move(*annotations), model);
}

fs::path annotation_file(const AnnotationConfig& config, const std::string& model) {
  constexpr std::string_view kDigits = "0123456789ABCDEF";
  std::string name;
  for (const char c : model) {
    const auto code = static_cast<unsigned char>(c);
    const bool plain =
        std::isalnum(code) != 0 || code >= 0x80 || c == '-' || c == '_' || c == ' ' || (c == '.' && !name.empty());
    if (plain) {
      name += c;
    } else {
      name += {'%', kDigits[code >> 4U], kDigits[code & 15U]};
    }
  }
  return config.folder / (name + ".json");
}

Result<Annotations> read_annotations(const AnnotationConfig& config, const std::string& model) {
  const fs::path file = annotation_file(config, model);
  std::error_code code;
  if (!fs::exists(file, code) && !code)
    return with_edition(text_of(ordered_json::array(), ordered_json::array(), model));
  const Result<std::string> content = content_of(file, config.bytes, model);
  if (!content) return fail(content);
  if (content->size() > config.bytes) return fail(ErrorKind::kLimit, "the annotations of " + model + " are too long");
  Result<std::string> document = normalized_annotations(*content, model);
  if (!document) return fail(ErrorKind::kIo, "the file of " + model + ": " + document.error().message);
  return with_edition(std::move(*document));
}

Result<Annotations> write_annotations(const AnnotationConfig& config, const std::string& model,
                                      std::string_view document, const std::optional<std::string>& replaced) {
  Result<std::string> normalized = normalized_annotations(document, model);
  if (!normalized) return fail(normalized);
  if (normalized->size() > config.bytes) {
    return fail(ErrorKind::kLimit,
                "the annotations of a model may have " + std::to_string(config.bytes) + " bytes at most");
  }
  if (replaced) {
    const Result<Annotations> present = read_annotations(config, model);
    if (!present) return fail(present);
    if (present->edition != *replaced) {
      return fail(ErrorKind::kReplaced, "the annotations have changed since they were read");
    }
  }
  if (!write_file_atomically(annotation_file(config, model), *normalized)) {
    return fail(ErrorKind::kIo, "the annotations of " + model + " cannot be written");
  }
  return with_edition(std::move(*normalized));
}

}  // namespace surfcast::net
