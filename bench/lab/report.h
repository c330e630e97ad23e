#pragma once

#include <string>

#include "base/result.h"
#include "lab/results.h"

namespace surfcast::lab {

/// The page of the documentation that contains the results, and the lines that enclose them.
inline constexpr const char* kResultsPage = "laboratory.md";
inline constexpr const char* kResultsBegin = "<!-- laboratory: begin -->";
inline constexpr const char* kResultsEnd = "<!-- laboratory: end -->";

/// All measurements as JSON.
std::string json_of(const LabResults& results);

/// The section of the documentation: methods, tables of scenes and methods, comparison with the kernel of the papers,
/// comparison with table 1 of Ren 2002, stage timings.
std::string markdown_of(const LabResults& results);

/// `text` with the part between the lines `begin` and `end` replaced. Fails unless each line occurs once, in this
/// order.
Result<std::string> with_section(const std::string& text, const std::string& begin, const std::string& end,
                                 const std::string& section);

}  // namespace surfcast::lab
