#include "scan/row_source.h"

#include <string>

namespace surfcast::scan {

Status DecodingLimit::check(uint64_t bytes) const {
  if (bytes <= max_bytes) return {};
  const auto mebibytes = [](uint64_t size) { return std::to_string((size >> 20) + 1) + "M"; };
  return fail(ErrorKind::kLimit, "can only be decoded whole, which takes " + mebibytes(bytes) + " of memory; " +
                                     mebibytes(max_bytes) + " are left for it");
}

}  // namespace surfcast::scan
