#pragma once

#include <string>
#include <vector>

#include "command_line/command_summary.h"

namespace surfcast::command_line {

/// A part of a manual page that the definition of the command line does not give.
struct ManualSection {
  std::string title;
  std::vector<std::string> paragraphs;
};

/// The page of a program in section 1 of the manual, for troff with the macros of man(7). `name` is that of the
/// program's file, `version` that of the project.
std::string manual_page(const CommandSummary& program, const std::string& name, const std::string& version,
                        const std::vector<ManualSection>& sections);

}  // namespace surfcast::command_line
