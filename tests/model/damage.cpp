#include "model/damage.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <ctime>
#include <fstream>
#include <span>

#include <gtest/gtest.h>

#include "model/counted_memory.h"
#include "model/format.h"

namespace surfcast::model {
namespace {

void put(Bytes& bytes, size_t at, uint64_t value) {
  if (at + sizeof(value) <= bytes.size()) std::memcpy(&bytes[at], &value, sizeof(value));
}

double processor_seconds() {
  timespec t{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + static_cast<double>(t.tv_nsec) * 1e-9;
}

/// Overwrites the previous file, because creating thousands of files is slow.
void overwrite(const std::filesystem::path& path, const Bytes& bytes) {
  std::ofstream(path, std::ios::binary | std::ios::app);
  std::fstream file(path, std::ios::binary | std::ios::in | std::ios::out);
  file.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  file.close();
  if (std::filesystem::file_size(path) != bytes.size()) std::filesystem::resize_file(path, bytes.size());
}

}  // namespace

Bytes content_of(const std::filesystem::path& path) {
  const std::vector<char> content = read_bytes(path);
  const auto bytes = std::as_bytes(std::span(content));
  return {bytes.begin(), bytes.end()};
}

// Offsets as in docs/model-format.md.
void repair_tables(Bytes& bytes, size_t directory) {
  if (bytes.size() < kHeaderBytes) return;
  put(bytes, 16, bytes.size());
  directory = std::min(directory, bytes.size());
  put(bytes, 24, directory);
  put(bytes, 32, bytes.size() - directory);
  put(bytes, 40, checksum_of(std::span(bytes).subspan(directory)));
  put(bytes, 56, checksum_of(std::span(bytes).first(56)));
}

void repair_blocks(Bytes& bytes, const Bytes& whole) {
  const ModelHeader header = *read_header(whole);
  const auto tables = std::span(whole).subspan(header.directory_offset);
  const Directory directory = *read_directory(tables, header);
  for (const BlockRecord& block : directory.blocks) {
    std::array<std::byte, sizeof(uint64_t)> old{};
    std::memcpy(old.data(), &block.checksum, sizeof(uint64_t));
    // Not std::ranges::search: clang 14 does not compile it.
    const auto found = std::search(tables.begin(), tables.end(), old.begin(), old.end());
    ASSERT_NE(found, tables.end());
    put(bytes, header.directory_offset + static_cast<size_t>(found - tables.begin()),
        checksum_of(std::span(bytes).subspan(block.offset, block.bytes)));
  }
}

Status read_within_bounds(const TestFolder& folder, const Bytes& bytes, size_t own_needs, const ReadAll& read_all) {
  const std::filesystem::path path = folder / "damaged.surf";
  overwrite(path, bytes);
  const size_t before = bytes_in_use();
  start_peak();
  const double start = processor_seconds();
  const Status status = read_all(path);
  EXPECT_LT(processor_seconds() - start, 1);
  EXPECT_LT(peak_bytes_in_use() - before, 2 * bytes.size() + own_needs);
  if (!status) {
    EXPECT_TRUE(status.error().kind == ErrorKind::kInvalidInput || status.error().kind == ErrorKind::kUnsupported)
        << status.error().message;
    EXPECT_NE(status.error().message.find("damaged.surf: "), std::string::npos) << status.error().message;
  }
  return status;
}

}  // namespace surfcast::model
