#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"
#include "scan/row_source.h"

namespace surfcast::scan {

/// Reads points from text: XYZ, PTS, CSV.
/// - Numbers are separated by spaces, tabs, commas or semicolons. In a file with semicolons a comma is no separator, so
///   decimal commas are an error instead of being read as two numbers.
/// - Lines that begin with # or // are comments. The last one before the numbers is a header if it has one word for
///   each column, among them x, y and z.
/// - A first line with a single integer is the number of rows (PTS). Further blocks with their own count may follow.
/// - Every row must have the same number of columns as the first.
/// - Without a header, columns are guessed (text_columns.h).
///
/// Text is assumed to come from surveys: z-up.
Result<std::unique_ptr<RowSource>> text_rows(std::span<const std::byte> bytes);

/// True if the lines before the rows and the first row are accepted by text_rows.
bool begins_like_text_table(std::string_view text);

/// The names of the columns in the header of a text that text_rows accepts; none without a header.
std::vector<std::string> text_column_names(std::string_view text);

}  // namespace surfcast::scan
