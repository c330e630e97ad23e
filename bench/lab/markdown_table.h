#pragma once

#include <string>
#include <vector>

namespace surfcast::lab {

/// "equal" for the infinite PSNR of two pictures that are the same.
std::string number(double value, int digits);
/// A line of a Markdown table.
std::string row(const std::vector<std::string>& cells);
/// The names of the columns and the line below them.
std::string header(const std::vector<std::string>& cells);

}  // namespace surfcast::lab
