#include "lab/markdown_table.h"

#include <cmath>
#include <cstdio>

namespace surfcast::lab {

std::string number(double value, int digits) {
  if (std::isinf(value)) return "equal";
  char text[32];
  std::snprintf(text, sizeof text, "%.*f", digits, value);
  return text;
}

std::string row(const std::vector<std::string>& cells) {
  std::string line = "|";
  for (const std::string& cell : cells) line += " " + cell + " |";
  return line + "\n";
}

std::string header(const std::vector<std::string>& cells) {
  return row(cells) + row(std::vector<std::string>(cells.size(), "---"));
}

}  // namespace surfcast::lab
