#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "base/result.h"
#include "scan/row_source.h"
#include "stream/mapped_stream.h"

namespace surfcast::gaussian {

/// Fetches a whole file of a SOG model by its name.
using FetchFile = std::function<Result<std::vector<std::byte>>(const std::string& name)>;

/// Files in a folder. Names that lead out of it are refused.
FetchFile files_in_folder(std::filesystem::path folder);

/// Files in a zip archive, in any folder of it. A file that is larger than the limit is refused.
Result<FetchFile> files_in_zip(const stream::FilePtr& archive, const scan::DecodingLimit& limit);

}  // namespace surfcast::gaussian
