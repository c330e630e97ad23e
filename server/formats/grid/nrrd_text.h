#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"

namespace surfcast::grid {

inline constexpr std::string_view kNrrd = "NRRD";

/// The names of fields in small letters without spaces, in which spellings differ.
using NrrdFields = std::map<std::string, std::string, std::less<>>;

/// The header of an NRRD file.
struct NrrdText {
  NrrdFields fields;
  std::vector<std::string> files;  ///< after "data file: LIST"
  bool attached = true;
  size_t data_offset = 0;
};

/// Splits a header into its fields. It ends at an empty line, or with the file.
Result<NrrdText> split_nrrd(std::string_view text);
/// The content of a field; empty where it is missing.
std::string_view field(const NrrdFields& fields, std::string_view name);

}  // namespace surfcast::grid
