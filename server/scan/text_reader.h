#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string_view>

#include "base/result.h"
#include "scan/row_source.h"

namespace surfcast::scan {

/// Points written as text: XYZ, PTS, CSV. Numbers are separated by spaces, tabs, commas or semicolons. In a file with
/// semicolons a comma does not separate, so that decimal commas are an error and not two numbers. Lines that begin with
/// # or // are comments; the last one before the numbers is a header when it has as many words as there are columns,
/// among them x, y and z. A first line with a single integer is the number of rows (PTS; further blocks with a count of
/// their own may follow). Every row must have as many numbers as the first. text_columns.h says what columns mean that
/// no header names. Text comes from surveys: z-up.
Result<std::unique_ptr<RowSource>> text_rows(std::span<const std::byte> bytes);

/// Whether everything before the rows, and the first row, is as text_rows takes it.
bool begins_like_text_table(std::string_view text);

}  // namespace surfcast::scan
