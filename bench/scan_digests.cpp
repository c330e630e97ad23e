// scan_digests [--bounds X,Y,Z,X,Y,Z] INPUT...: what independent readers of the same scans can be compared by, a line
// of tab-separated values each: input, points, SHA-256 of the finite positions (doubles) and of their colours (u8, or
// u16 of colours with 16 bits) in file order, finite points, lowest and highest corner, mean, bits of a colour, and the
// attributes with their ranges.

#include <cmath>
#include <cstdio>
#include <iostream>
#include <string>
#include <vector>

#include <openssl/evp.h>

#include "scan/scan_stream.h"

namespace {

using namespace surfcast;

/// SHA-256 of what is added.
class Digest {
 public:
  Digest() : context_(EVP_MD_CTX_new(), EVP_MD_CTX_free) { EVP_DigestInit_ex(context_.get(), EVP_sha256(), nullptr); }
  template <typename T>
  void add(const T& value) {
    EVP_DigestUpdate(context_.get(), &value, sizeof(T));
  }
  std::string text() {
    unsigned char sum[EVP_MAX_MD_SIZE];
    unsigned int size = 0;
    EVP_DigestFinal_ex(context_.get(), sum, &size);
    std::string digits;
    for (unsigned int i = 0; i < size; ++i) {
      char pair[3];
      std::snprintf(pair, sizeof(pair), "%02x", sum[i]);
      digits += pair;
    }
    return digits;
  }

 private:
  std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> context_;
};

struct Range {
  double low = INFINITY;
  double high = -INFINITY;
};

struct Totals {
  uint64_t points = 0;
  uint64_t usable = 0;
  Digest positions;
  Digest colors;
  geometry::Box bounds;
  glm::dvec3 sum{0};
  glm::dvec3 lost{0};  ///< of the sum (Kahan)
  std::vector<Range> scalars;

  void add_mean(const glm::dvec3& position) {
    const glm::dvec3 now = position - lost;
    const glm::dvec3 next = sum + now;
    lost = (next - sum) - now;
    sum = next;
  }
  void add_color(const surfel::ColorAttribute& attribute, size_t i) {
    for (int channel = 0; channel < 3; ++channel) {
      const uint16_t value = attribute.values[i][channel];
      if (attribute.bits == 8) colors.add(static_cast<uint8_t>(value));
      if (attribute.bits == 16) colors.add(value);
    }
  }
  void add(const scan::ScanPoints& piece) {
    scalars.resize(piece.scalars.size());
    for (size_t i = 0; i < piece.size(); ++i, ++points) {
      const glm::dvec3& p = piece.positions[i];
      if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) continue;
      ++usable;
      positions.add(p);
      bounds.include(p);
      add_mean(p);
      if (piece.colors) add_color(*piece.colors, i);
      for (size_t k = 0; k < scalars.size(); ++k) {
        const double v =
            std::visit([i](const auto& values) { return static_cast<double>(values[i]); }, piece.scalars[k].values);
        scalars[k].low = std::fmin(scalars[k].low, v);
        scalars[k].high = std::fmax(scalars[k].high, v);
      }
    }
  }
};

std::string triple(const glm::dvec3& v) {
  char text[128];
  std::snprintf(text, sizeof(text), "%.17g,%.17g,%.17g", v.x, v.y, v.z);
  return text;
}

std::string line_of(Totals& totals, const scan::ScanSchema& schema) {
  std::string text = std::to_string(totals.points) + '\t' + totals.positions.text() + '\t' +
                     (schema.color_bits > 0 ? totals.colors.text() : "-") + '\t' + std::to_string(totals.usable) +
                     '\t' + triple(totals.bounds.min) + '\t' + triple(totals.bounds.max) + '\t' +
                     triple(totals.sum / static_cast<double>(totals.usable)) + '\t' +
                     std::to_string(schema.color_bits) + '\t';
  for (size_t k = 0; k < totals.scalars.size(); ++k) {
    char range[96];
    std::snprintf(range, sizeof(range), "=%.17g..%.17g;", totals.scalars[k].low, totals.scalars[k].high);
    text += schema.scalars[k].name + range;
  }
  return text;
}

Result<std::string> digests_of(const char* path, const scan::Selection& selection) {
  const Result<scan::ScanStream> stream = scan::ScanStream::open(path, {}, {}, selection);
  if (!stream) return fail(stream);
  Totals totals;
  for (size_t piece = 0; piece < stream->pieces(); ++piece) {
    const Result<scan::ScanPoints> points = stream->read(piece);
    if (!points) return fail(points);
    totals.add(*points);
  }
  return line_of(totals, stream->schema());
}

}  // namespace

int main(int argc, char** argv) {
  scan::Selection selection;
  int first = 1;
  if (argc > 2 && std::string(argv[1]) == "--bounds") {
    geometry::Box box;
    if (std::sscanf(argv[2], "%lf,%lf,%lf,%lf,%lf,%lf", &box.min.x, &box.min.y, &box.min.z, &box.max.x, &box.max.y,
                    &box.max.z) != 6) {
      return 2;
    }
    selection.zone.boxes = {box};
    first = 3;
  }
  int failures = 0;
  for (int i = first; i < argc; ++i) {
    const Result<std::string> line = digests_of(argv[i], selection);
    std::cout << argv[i] << '\t' << (line ? *line : "error: " + line.error().message) << '\n';
    failures += line ? 0 : 1;
  }
  return failures > 0 ? 1 : 0;
}
