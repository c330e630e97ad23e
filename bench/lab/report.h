#pragma once

#include <string>

#include "base/result.h"
#include "lab/results.h"

namespace surfcast::lab {

/// The page of the documentation that holds the results, and the lines between which they are.
inline constexpr const char* kResultsPage = "laboratory.md";
inline constexpr const char* kResultsBegin = "<!-- laboratory: begin -->";
inline constexpr const char* kResultsEnd = "<!-- laboratory: end -->";

/// Everything that was measured, as JSON.
std::string json_of(const LabResults& results);

/// The section of the documentation: methods, tables of method by scene, what the kernel gains over the papers', Ren's
/// table 1 beside ours, stage timings.
std::string markdown_of(const LabResults& results);

/// `text` with what lies between the lines `begin` and `end` replaced. Fails unless each is there once, in this order.
Result<std::string> with_section(const std::string& text, const std::string& begin, const std::string& end,
                                 const std::string& section);

}  // namespace surfcast::lab
