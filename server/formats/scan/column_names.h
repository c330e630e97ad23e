#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "scan/table_facts.h"

namespace surfcast::scan {

/// A name without case, underscores, hyphens and spaces, and without a leading "scalar".
std::string attribute_key(std::string_view name);

/// The canonical name of an attribute: a well-known name if `name` is a spelling of it ("ReturnNumber",
/// "scalar_intensity", "normal_x", "diffuse_red"), otherwise `name` itself.
std::string canonical_attribute_name(std::string_view name);

/// Guesses the columns of a text file without a header, from their number and values:
///   - the first three are x, y and z;
///   - with 4, 7 or 10 columns there is one single column. It is the intensity and precedes the triples. Exception: if
///     three columns hold colours and the column after them is 255 throughout or cannot be a colour channel, that last
///     column is the single one: "alpha" or "column_7". In a PTS file the intensity always comes first;
///   - three columns that are unit vectors (or zero) in every row are a normal. Three columns that hold only integers
///     up to 255, or up to 65535, or only values from 0 to 1, are a colour;
///   - every other column is called "column_N", with N counting from 1.
std::vector<std::string> guess_column_names(const TableFacts& facts, bool counted);

}  // namespace surfcast::scan
