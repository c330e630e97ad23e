#include "scan/row_source.h"

#include <string>

namespace surfcast::scan {

Status DecodingLimit::check(uint64_t bytes) const {
  if (bytes <= max_bytes) return {};
  const auto mebibytes = [](uint64_t size) { return std::to_string((size >> 20) + 1) + "M"; };
  return fail(ErrorKind::kLimit, "can only be decoded whole, which takes " + mebibytes(bytes) + " of memory; " +
                                     mebibytes(max_bytes) + " are left for it");
}

Status check_announced(uint64_t rows, uint64_t announced) {
  if (rows >= announced) return {};
  return fail(ErrorKind::kInvalidInput,
              "truncated: the file states " + std::to_string(announced) + " points and holds " + std::to_string(rows));
}

}  // namespace surfcast::scan
