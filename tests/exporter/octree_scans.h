#pragma once

#include <cmath>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "exporter/export_scan.h"
#include "scan/las_file.h"

namespace surfcast::exporter {

/// A record before the points.
inline std::string named_record(const std::string& user, uint16_t id, const std::string& body) {
  testing::Bytes record(std::string(54, '\0'));
  for (size_t i = 0; i < user.size(); ++i) record.set(2 + i, user[i]);
  record.set(18, id).set(20, static_cast<uint16_t>(body.size())).add_text(body);
  return record.text();
}

/// A hilly surface of random points with any attributes, denser on one side, and a few points far from it.
inline testing::LasFile hills(int format, size_t count = 6000) {
  testing::LasFile file;
  file.format = format;
  file.minor = format < 6 ? 2 : 4;
  file.extra_bytes = 3;
  file.scale[2] = 0.002;
  file.offset[0] = 4.5e6;
  file.variable_records = named_record("LASF_Projection", 2112, "PROJCS[\"somewhere\"]") +
                          named_record("somebody", 7, "something of theirs");
  file.variable_record_count = 2;
  std::mt19937 random(11);
  std::uniform_real_distribution<double> number(0, 1);
  for (size_t i = 0; i < count; ++i) {
    const double u = std::pow(number(random), 2), v = number(random);
    const double height = i % 50 == 0 ? 30000 * number(random) : 4000 * std::sin(7 * u) * std::cos(5 * v);
    testing::Bytes record =
        file.record(static_cast<int32_t>(10000 * u), static_cast<int32_t>(9000 * v), static_cast<int32_t>(height));
    std::string text = record.text();
    for (size_t at = 12; at < text.size(); ++at) text[at] = static_cast<char>(random());
    testing::Bytes whole(text);
    if (format >= 6) whole.set(22, 1000 * number(random));
    file.records.push_back(whole.text());
  }
  return file;
}

/// The same with extra bytes that have a name.
inline testing::LasFile hills_with_quality(int format) {
  testing::LasFile file = hills(format);
  testing::Bytes extra(std::string(192, '\0'));
  extra.set<uint8_t>(2, 3);  // 16 bits, unsigned
  std::string entry = extra.text();
  entry.replace(4, 7, "quality");
  file.variable_records += named_record("LASF_Spec", 4, entry);
  file.variable_record_count += 1;
  return file;
}

inline ExportOptions few_points_a_node() {
  ExportOptions options;
  options.encoding.chunk_size = 200;
  return options;
}

}  // namespace surfcast::exporter
