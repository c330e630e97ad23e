#include <algorithm>
#include <vector>

#include "command_line/parse_failure.h"

namespace surfcast::command_line {
namespace {

constexpr size_t kMaxEdits = 2;

/// The optimal string alignment distance.
size_t edits_between(std::string_view a, std::string_view b) {
  std::vector<std::vector<size_t>> edits(a.size() + 1, std::vector<size_t>(b.size() + 1));
  for (size_t i = 0; i <= a.size(); ++i) {
    for (size_t j = 0; j <= b.size(); ++j) {
      if (i == 0 || j == 0) {
        edits[i][j] = i + j;
        continue;
      }
      const size_t replaced = edits[i - 1][j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      edits[i][j] = std::min({edits[i - 1][j] + 1, edits[i][j - 1] + 1, replaced});
      const bool swapped = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
      if (swapped) edits[i][j] = std::min(edits[i][j], edits[i - 2][j - 2] + 1);
    }
  }
  return edits[a.size()][b.size()];
}

}  // namespace

std::optional<std::string> closest_word(std::string_view typed, std::span<const std::string> words) {
  std::optional<std::string> closest;
  size_t fewest = std::min(kMaxEdits + 1, typed.size());
  for (const std::string& word : words) {
    const bool begun = !typed.empty() && word.starts_with(typed);
    const size_t edits = begun ? 0 : edits_between(typed, word);
    if (edits >= fewest) continue;
    fewest = edits;
    closest = word;
  }
  return closest;
}

}  // namespace surfcast::command_line
