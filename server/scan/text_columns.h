#pragma once

#include <string>
#include <vector>

#include "scan/table_facts.h"

namespace surfcast::scan {

/// What the columns of a text file without a header are, by how many there are and the values they hold:
///   - the first three are x, y and z;
///   - with a remainder of one (4, 7 or 10 columns) there is an intensity before the triples. Only where three columns
///     hold colours and the single one behind them is 255 throughout, or holds anything but colour values, is that
///     last one the odd one out: "alpha" or "column_7". In a PTS file the intensity always comes first;
///   - three columns that are unit vectors (or zero) in every row are a normal; three that hold only integers up to
///     255, or up to 65535, or only values from 0 to 1, are a colour;
///   - every other column is called "column_N", N counting from 1.
std::vector<std::string> guess_column_names(const TableFacts& facts, bool counted);

}  // namespace surfcast::scan
