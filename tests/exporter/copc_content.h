#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <glm/common.hpp>
#include <iterator>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "laz/laz_file.h"
#include "scan/bytes.h"
#include "scan/las_header.h"

namespace surfcast::exporter {

/// A node as the hierarchy of a COPC file states it, with its records.
struct CopcContentNode {
  int32_t level = 0;
  glm::ivec3 place{0};
  uint64_t offset = 0;
  int32_t bytes = 0;
  int32_t points = 0;
  std::vector<std::string> records;

  friend bool operator==(const CopcContentNode&, const CopcContentNode&) = default;
};

/// The content of a COPC file, read after the specification and not after the reader.
class CopcContent {
 public:
  explicit CopcContent(const std::filesystem::path& path) {
    std::ifstream in(path, std::ios::binary);
    text_.assign(std::istreambuf_iterator<char>(in), {});
    const Result<scan::LasHeader> header = scan::parse_las_header(bytes());
    EXPECT_TRUE(header) << header.error().message;
    if (!header) return;
    header_ = *header;
    EXPECT_EQ(at<uint16_t>(94), 375);
    EXPECT_EQ(text_.substr(377, 5), std::string("copc\0", 5));
    EXPECT_EQ(at<uint16_t>(393), 1);
    EXPECT_EQ(at<uint16_t>(395), 160);
    read_page(at<uint64_t>(kInfo + 40), at<uint64_t>(kInfo + 48));
    std::sort(nodes_.begin(), nodes_.end(), [](const CopcContentNode& a, const CopcContentNode& b) {
      return std::array{a.level, a.place.x, a.place.y, a.place.z} <
             std::array{b.level, b.place.x, b.place.y, b.place.z};
    });
  }

  [[nodiscard]] const std::string& text() const { return text_; }
  [[nodiscard]] const scan::LasHeader& header() const { return header_; }
  /// By level, then by place.
  [[nodiscard]] const std::vector<CopcContentNode>& nodes() const { return nodes_; }
  [[nodiscard]] size_t pages() const { return pages_; }

  template <typename T>
  [[nodiscard]] T at(size_t offset) const {
    return scan::load<T>(&bytes()[offset]);
  }
  [[nodiscard]] double half() const { return at<double>(kInfo + 24); }
  [[nodiscard]] double spacing() const { return at<double>(kInfo + 32); }
  [[nodiscard]] double least_time() const { return at<double>(kInfo + 56); }
  [[nodiscard]] double most_time() const { return at<double>(kInfo + 64); }
  [[nodiscard]] double side(const CopcContentNode& node) const { return std::ldexp(2 * half(), -node.level); }
  [[nodiscard]] glm::dvec3 low_corner(const CopcContentNode& node) const {
    const glm::dvec3 centre(at<double>(kInfo), at<double>(kInfo + 8), at<double>(kInfo + 16));
    return centre - half() + side(node) * glm::dvec3(node.place);
  }
  [[nodiscard]] glm::dvec3 position(const std::string& record) const {
    const auto* first = reinterpret_cast<const std::byte*>(record.data());
    return header_.grid.position(
        {scan::load<int32_t>(first), scan::load<int32_t>(first + 4), scan::load<int32_t>(first + 8)});
  }
  /// All records, sorted.
  [[nodiscard]] std::vector<std::string> records() const {
    std::vector<std::string> all;
    for (const CopcContentNode& node : nodes_) all.insert(all.end(), node.records.begin(), node.records.end());
    std::sort(all.begin(), all.end());
    return all;
  }

 private:
  static constexpr size_t kInfo = 375 + 54;

  [[nodiscard]] std::span<const std::byte> bytes() const { return testing::as_bytes(text_); }

  void read_page(uint64_t offset, uint64_t size) {
    ++pages_;
    EXPECT_EQ(size % 32, 0U);
    for (uint64_t i = offset; i < offset + size; i += 32) {
      const int32_t points = at<int32_t>(i + 28);
      if (points == -1) {
        read_page(at<uint64_t>(i + 16), static_cast<uint64_t>(at<int32_t>(i + 24)));
        continue;
      }
      nodes_.push_back({at<int32_t>(i),
                        {at<int32_t>(i + 4), at<int32_t>(i + 8), at<int32_t>(i + 12)},
                        at<uint64_t>(i + 16),
                        at<int32_t>(i + 24),
                        points,
                        {}});
      if (points != 0) decode(nodes_.back());
    }
  }

  void decode(CopcContentNode& node) const {
    const laz::LazPoints points{header_.point_format, header_.record_length, header_.count, header_.data_offset};
    const laz::Chunk chunk{0, static_cast<uint64_t>(node.points), node.offset, static_cast<size_t>(node.bytes)};
    const auto file = laz::LazFile::open_chunks(bytes(), points, header_.laszip_record, {chunk});
    ASSERT_TRUE(file) << file.error().message;
    auto reader = file->read_chunk(chunk);
    ASSERT_TRUE(reader);
    std::vector<std::byte> records(static_cast<size_t>(node.points) * header_.record_length);
    ASSERT_TRUE(reader->read(records));
    for (size_t i = 0; i < records.size(); i += header_.record_length)
      node.records.emplace_back(reinterpret_cast<const char*>(&records[i]), header_.record_length);
  }

  std::string text_;
  scan::LasHeader header_;
  std::vector<CopcContentNode> nodes_;
  size_t pages_ = 0;
};

}  // namespace surfcast::exporter
