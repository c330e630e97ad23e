#include "gaussian/sog_meta.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "base/json_text.h"
#include "scan/text_tokens.h"

namespace surfcast::gaussian {
namespace {

using nlohmann::json;

/// Pictures of WebP have at most 2^28 pixels.
constexpr uint64_t kMaxGaussians = uint64_t{1} << 28;
constexpr uint64_t kLargestPalette = 65536;

/// Reads values and notes the first that is wrong.
class Values {
 public:
  explicit Values(const json& root) : root_(root) {}

  [[nodiscard]] const std::string& wrong() const { return wrong_; }
  [[nodiscard]] bool has(const char* key) const { return root_.contains(key); }

  uint64_t count(const char* path, uint64_t most) {
    const json* value = find(path);
    const bool right = value != nullptr && value->is_number_unsigned() && value->get<uint64_t>() <= most;
    return right ? value->get<uint64_t>() : note<uint64_t>(path);
  }

  std::vector<double> numbers(const char* path, size_t wanted) {
    const json* list = find(path);
    const bool right = list != nullptr && list->is_array() && list->size() == wanted &&
                       std::all_of(list->begin(), list->end(), [](const json& v) { return v.is_number(); });
    return right ? list->get<std::vector<double>>() : note(path, std::vector<double>(wanted));
  }

  std::vector<std::string> names(const char* path, size_t wanted) {
    const json* list = find(path);
    const bool right = list != nullptr && list->is_array() && list->size() == wanted &&
                       std::all_of(list->begin(), list->end(), [](const json& v) { return v.is_string(); });
    return right ? list->get<std::vector<std::string>>() : note(path, std::vector<std::string>(wanted));
  }

  bool flag(const char* key) { return root_.contains(key) && root_[key].is_boolean() && root_[key].get<bool>(); }

  Codebook codebook(const char* path) {
    const std::vector<double> values = numbers(path, std::tuple_size_v<Codebook>);
    Codebook codebook{};
    std::copy(values.begin(), values.end(), codebook.begin());
    return codebook;
  }

  glm::dvec3 vector(const char* path) {
    const std::vector<double> values = numbers(path, 3);
    return {values[0], values[1], values[2]};
  }

 private:
  /// A path is a JSON pointer; none if there is nothing.
  [[nodiscard]] const json* find(const char* path) const {
    const json::json_pointer pointer(path);
    return root_.contains(pointer) ? &root_[pointer] : nullptr;
  }

  template <typename T>
  T note(const char* path, T fallback = {}) {
    if (wrong_.empty()) wrong_ = path + 1;
    return fallback;
  }

  const json& root_;
  std::string wrong_;
};

SogPalette parse_palette(Values& values) {
  SogPalette palette;
  palette.count = values.count("/shN/count", kLargestPalette);
  palette.degree = static_cast<int>(values.count("/shN/bands", 3));
  palette.codebook = values.codebook("/shN/codebook");
  const std::vector<std::string> files = values.names("/shN/files", 2);
  palette.centroids = files[0];
  palette.labels = files[1];
  return palette;
}

SogMeta parse_values(Values& values) {
  SogMeta meta;
  meta.count = values.count("/count", kMaxGaussians);
  meta.antialiased = values.flag("antialias");
  meta.min = values.vector("/means/mins");
  meta.max = values.vector("/means/maxs");
  const std::vector<std::string> means = values.names("/means/files", 2);
  meta.means_low = means[0];
  meta.means_high = means[1];
  meta.scales = values.codebook("/scales/codebook");
  meta.scale_codes = values.names("/scales/files", 1)[0];
  meta.quats = values.names("/quats/files", 1)[0];
  meta.colors = values.codebook("/sh0/codebook");
  meta.color_codes = values.names("/sh0/files", 1)[0];
  if (values.has("shN")) meta.palette = parse_palette(values);
  // A palette without bands says nothing.
  if (meta.palette && meta.palette->degree == 0) meta.palette.reset();
  return meta;
}

}  // namespace

bool looks_like_sog_meta(std::string_view text) {
  const size_t first = text.find_first_not_of(" \t\r\n");
  return first != std::string_view::npos && text[first] == '{' && text.find("\"means\"") != std::string_view::npos;
}

Result<SogMeta> parse_sog_meta(std::string_view text) {
  const json root = parse_json_text(text);
  if (!root.is_object()) return fail(ErrorKind::kInvalidInput, "damaged JSON");
  const json version = root.value("version", json(1));
  if (version != 2) {
    return fail(ErrorKind::kUnsupported, "SOG version " + scan::printable(json_text(version)) + "; 2 is read");
  }
  Values values(root);
  SogMeta meta = parse_values(values);
  if (!values.wrong().empty()) {
    return fail(ErrorKind::kInvalidInput, "SOG description: " + values.wrong() + " is missing or wrong");
  }
  if (meta.count == 0) return fail(ErrorKind::kInvalidInput, "has no Gaussians");
  return meta;
}

std::vector<std::string> picture_names(const SogMeta& meta) {
  std::vector<std::string> names{meta.means_low, meta.means_high, meta.quats, meta.scale_codes, meta.color_codes};
  if (meta.palette) names.insert(names.end(), {meta.palette->centroids, meta.palette->labels});
  return names;
}

}  // namespace surfcast::gaussian
