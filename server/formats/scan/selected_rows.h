#pragma once

#include <memory>

#include "base/result.h"
#include "scan/row_source.h"
#include "scan/selection.h"

namespace surfcast::scan {

/// The rows in the selection. Fails if classes are selected and the rows have none.
Result<std::unique_ptr<RowSource>> select_rows(std::unique_ptr<RowSource> rows, const Selection& selection);

}  // namespace surfcast::scan
