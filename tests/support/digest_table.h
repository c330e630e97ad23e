#pragma once

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

namespace surfcast::testing {

/// A row of a table of files whose content other decoders have read: columns "file", "points" and so on.
struct DigestRow {
  std::string file;    ///< below the folder of the table
  uint64_t count = 0;  ///< points, or numbers of a grid
  std::string values;  ///< SHA-256 of positions, or of the numbers of a grid, as doubles
  std::string colors;  ///< SHA-256 of colours of 8 bits; "-" without
  std::string min;
  std::string max;
  std::string mean;
  std::string attributes;  ///< name=smallest..largest;...
};

/// The folder that the environment names for tests of real files, if there is one.
inline std::optional<std::filesystem::path> real_data() {
  const char* folder = std::getenv("SURFCAST_REAL_DATA");
  return folder == nullptr ? std::nullopt : std::optional<std::filesystem::path>(folder);
}

/// The rows of format-digests.tsv whose files are in this subfolder.
inline std::vector<DigestRow> digest_rows(const std::filesystem::path& folder, const std::string& subfolder) {
  std::ifstream file(folder / "format-digests.tsv");
  std::vector<DigestRow> rows;
  for (std::string line; std::getline(file, line);) {
    if (!line.starts_with(subfolder + "/")) continue;
    std::vector<std::string> cells;
    std::istringstream words(line);
    for (std::string cell; std::getline(words, cell, '\t');) cells.push_back(cell);
    if (cells.size() < 11) continue;
    rows.push_back({cells[0], std::stoull(cells[1]), cells[2], cells[3], cells[6], cells[7], cells[8], cells[10]});
  }
  return rows;
}

/// Numbers separated by commas.
inline std::vector<double> numbers_in(const std::string& cell) {
  std::vector<double> numbers;
  std::istringstream words(cell);
  for (std::string word; std::getline(words, word, ',');) numbers.push_back(std::stod(word));
  return numbers;
}

}  // namespace surfcast::testing
