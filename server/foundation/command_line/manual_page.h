#pragma once

#include <string>
#include <vector>

#include "command_line/command_summary.h"

namespace surfcast::command_line {

/// A section of a manual page that cannot be derived from the command line's definition.
struct ManualSection {
  std::string title;
  std::vector<std::string> paragraphs;
};

/// The manual page of a program (section 1), for troff with the man(7) macros. `name` is the name of the program's
/// file, `version` the version of the project.
std::string manual_page(const CommandSummary& program, const std::string& name, const std::string& version,
                        const std::vector<ManualSection>& sections);

}  // namespace surfcast::command_line
