#include "scan/e57_pages.h"

#include <algorithm>
#include <cstring>
#include <string>

#include "base/invalid_input.h"
#include "scan/crc32c.h"
#include "scan/scalar_type.h"

namespace surfcast::scan {
namespace {

constexpr size_t kHeaderBytes = 48;
constexpr uint64_t kSmallestPage = 64;
constexpr uint64_t kLargestPage = uint64_t{1} << 20;

}  // namespace

Result<E57Pages> E57Pages::open(std::span<const std::byte> file) {
  if (file.size() < kHeaderBytes) return invalid_input("truncated: the file ends within its E57 header");
  const auto major = load<uint32_t>(&file[8]);
  if (major != 1) return fail(ErrorKind::kUnsupported, "E57 version " + std::to_string(major) + " is not supported");
  E57Pages pages(file);
  pages.xml_offset_ = load<uint64_t>(&file[24]);
  pages.xml_size_ = load<uint64_t>(&file[32]);
  pages.page_size_ = load<uint64_t>(&file[40]);
  if (pages.page_size_ < kSmallestPage || pages.page_size_ > kLargestPage) {
    return invalid_input("E57 pages of " + std::to_string(pages.page_size_) + " bytes cannot be");
  }
  pages.pages_ = file.size() / pages.page_size_;
  const auto stated = load<uint64_t>(&file[16]);
  if (stated > file.size()) {
    return invalid_input("truncated: the E57 header states " + std::to_string(stated) + " bytes, the file has " +
                         std::to_string(file.size()));
  }
  return pages;
}

Result<uint64_t> E57Pages::logical(uint64_t physical) const {
  const uint64_t page = physical / page_size_;
  const uint64_t within = physical % page_size_;
  if (page >= pages_)
    return invalid_input("truncated: offset " + std::to_string(physical) + " lies beyond the E57 file");
  if (within >= payload())
    return invalid_input("offset " + std::to_string(physical) + " lies in a checksum of the E57 file");
  return page * payload() + within;
}

Status E57Pages::check_page(uint64_t page) const {
  const std::span<const std::byte> bytes = file_.subspan(page * page_size_, page_size_);
  const auto stated = load<uint32_t>(&bytes[payload()], true);  // big-endian, in a little-endian file
  if (crc32c(bytes.first(payload())) == stated) return {};
  return invalid_input("the checksum of E57 page " + std::to_string(page) + " is wrong");
}

Status E57Pages::read(uint64_t logical, std::span<std::byte> to) const {
  if (logical > size() || to.size() > size() - logical)
    return invalid_input("truncated: the E57 file ends within its data");
  while (!to.empty()) {
    const uint64_t page = logical / payload();
    const uint64_t within = logical % payload();
    const size_t now = std::min<uint64_t>(to.size(), payload() - within);
    if (Status status = check_page(page); !status) return status;
    std::memcpy(to.data(), &file_[page * page_size_ + within], now);
    to = to.subspan(now);
    logical += now;
  }
  return {};
}

}  // namespace surfcast::scan
