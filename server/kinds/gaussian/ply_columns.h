#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "scan/row_source.h"
#include "stream/mapped_stream.h"

namespace surfcast::gaussian {

/// Columns of an element of a PLY file, by name and by rows.
class PlyColumns {
 public:
  static Result<PlyColumns> open(const stream::FilePtr& file, std::string_view element);

  [[nodiscard]] bool has(std::string_view name) const { return columns_.contains(name); }
  [[nodiscard]] size_t columns() const { return columns_.size(); }
  /// The type of a column that is there.
  [[nodiscard]] scan::ScalarType type(std::string_view name) const;

  /// Calls `use(i, value)` for rows [first, first + count) of a column that is there, i from 0; values as T.
  template <typename T, typename Use>
  Status for_each(std::string_view name, uint64_t first, uint64_t count, Use&& use) {
    const size_t column = columns_.find(name)->second;
    for (uint64_t done = 0; done < count;) {
      const uint64_t row = first + done;
      if (Status status = load(row / scan::kPieceRows); !status) return status;
      const uint64_t within = row % scan::kPieceRows;
      const uint64_t rows = std::min(count - done, table_.rows - within);
      scan::Column part = table_.columns[column];
      part.first += within * part.stride;
      scan::for_each_value(part, rows, [&](size_t i, auto value) { use(done + i, static_cast<T>(value)); });
      done += rows;
    }
    return {};
  }

 private:
  PlyColumns(stream::FilePtr file, std::unique_ptr<scan::RowSource> rows);
  Status load(size_t piece);

  stream::FilePtr file_;
  std::unique_ptr<scan::RowSource> rows_;
  std::map<std::string, size_t, std::less<>> columns_;
  std::optional<size_t> loaded_;
  scan::PointTable table_;
};

}  // namespace surfcast::gaussian
