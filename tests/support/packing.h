#pragma once

#include <string>
#include <string_view>

namespace surfcast::testing {

// Compressors, by the libraries that define the formats.
std::string gzip(std::string_view text);
std::string zlib(std::string_view text);
std::string bzip2(std::string_view text);
std::string zstd(std::string_view text);
std::string base64(std::string_view text);

}  // namespace surfcast::testing
