#include "gaussian/ply_columns.h"

#include <utility>

#include "scan/readers.h"

namespace surfcast::gaussian {

PlyColumns::PlyColumns(stream::FilePtr file, std::unique_ptr<scan::RowSource> rows)
    : file_(std::move(file)), rows_(std::move(rows)) {
  for (size_t i = 0; i < rows_->columns().size(); ++i) columns_.emplace(rows_->columns()[i].name, i);
}

Result<PlyColumns> PlyColumns::open(const stream::FilePtr& file, std::string_view element) {
  Result<std::unique_ptr<scan::RowSource>> rows = scan::ply_element_rows(file->bytes(), element);
  if (!rows) return fail(rows);
  return PlyColumns(file, std::move(*rows));
}

scan::ScalarType PlyColumns::type(std::string_view name) const {
  return rows_->columns()[columns_.find(name)->second].type;
}

Status PlyColumns::load(size_t piece) {
  if (loaded_ == piece) return {};
  Result<scan::PointTable> table = rows_->read(piece);
  if (!table) return fail(table);
  table_ = std::move(*table);
  loaded_ = piece;
  file_->release_pages();
  return {};
}

}  // namespace surfcast::gaussian
