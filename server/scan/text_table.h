#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"

namespace surfcast {

/// A text file of numbers in rows of one length.
struct TextTable {
  size_t columns = 0;
  std::vector<double> values;      ///< row by row
  std::vector<std::string> names;  ///< of the columns, when a header line says so, else empty
  bool counted = false;            ///< PTS: a line with the number of rows stands before them

  [[nodiscard]] size_t rows() const { return values.size() / columns; }
};

/// Reads numbers separated by spaces, tabs, commas or semicolons. In a file with semicolons a comma does not separate,
/// so that decimal commas are an error and not two numbers. Lines that begin with # or // are comments; the last one
/// before the numbers is a header when it has as many words as there are columns, among them x, y and z. A first line
/// with a single integer is the number of rows (PTS; further blocks with a count of their own may follow). Every row
/// must have as many numbers as the first.
Result<TextTable> parse_text_table(std::string_view text);

/// Whether everything before the rows, and the first row, is as parse_text_table takes it.
bool begins_like_text_table(std::string_view text);

}  // namespace surfcast
