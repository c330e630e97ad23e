#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "ellipsoid/ellipsoid_input.h"
#include "stream/mapped_stream.h"

namespace surfcast::ellipsoid {

/// The names of the columns of a PLY file or a text with a header; none of other files.
[[nodiscard]] std::vector<std::string> table_columns(const stream::FilePtr& file);

/// True if the columns have the shape of ellipsoids; semi-axes without a rotation only if `asked`.
[[nodiscard]] bool is_ellipsoid_table(const stream::FilePtr& file, bool asked);

/// Rows of a table as ellipsoids. Colours and all other numbers are kept.
Result<InputPtr> open_table(const stream::FilePtr& file, const std::filesystem::path& path,
                            const InputOptions& options);

}  // namespace surfcast::ellipsoid
