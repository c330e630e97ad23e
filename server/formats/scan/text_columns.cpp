#include <algorithm>
#include <array>

#include "scan/column_names.h"

namespace surfcast::scan {
namespace {

bool may_be_color(const ColumnFacts& facts) {
  return facts.min >= 0 && ((facts.integers && facts.max <= 65535) || facts.max <= 1);
}

bool is_opaque(const ColumnFacts& facts) {
  return facts.integers && facts.min == 255 && facts.max == 255;
}

/// Names the columns after the third, from left to right.
class Guess {
 public:
  Guess(const TableFacts& facts, bool counted) : facts_(facts), counted_(counted) {}

  std::vector<std::string> run() {
    while (names_.size() < facts_.columns.size()) {
      const size_t left = facts_.columns.size() - names_.size();
      const bool single_first = left % 3 == 1 && !single_is_last();
      if (!single_first && left >= 3 && !has_normal_ && is_normal(names_.size())) {
        add({"nx", "ny", "nz"}, has_normal_);
      } else if (!single_first && left >= 3 && !has_color_ && is_color(names_.size())) {
        add({"red", "green", "blue"}, has_color_);
      } else {
        names_.push_back(single_name());
      }
    }
    return std::move(names_);
  }

 private:
  [[nodiscard]] bool is_normal(size_t column) const {
    return facts_.units[column].unit_or_zero && facts_.units[column].any;
  }
  [[nodiscard]] bool is_color(size_t column) const {
    return std::all_of(&facts_.columns[column], &facts_.columns[column] + 3, may_be_color);
  }

  /// True if the single column follows a colour (see the header).
  [[nodiscard]] bool single_is_last() const {
    const size_t at = names_.size();
    if (counted_ || has_color_ || facts_.columns.size() - at != 4 || !is_color(at)) return false;
    const ColumnFacts& last = facts_.columns[at + 3];
    return is_opaque(last) || !may_be_color(last);
  }

  std::string single_name() {
    const size_t at = names_.size();
    if (has_color_ && at + 1 == facts_.columns.size() && is_opaque(facts_.columns[at])) return "alpha";
    if (!has_intensity_ && !has_color_ && (facts_.columns.size() - at) % 3 == 1) {
      has_intensity_ = true;
      return "intensity";
    }
    return "column_" + std::to_string(at + 1);
  }

  void add(const std::array<const char*, 3>& triple, bool& has) {
    names_.insert(names_.end(), triple.begin(), triple.end());
    has = true;
  }

  const TableFacts& facts_;
  bool counted_;
  std::vector<std::string> names_ = {"x", "y", "z"};
  bool has_normal_ = false;
  bool has_color_ = false;
  bool has_intensity_ = false;
};

}  // namespace

std::vector<std::string> guess_column_names(const TableFacts& facts, bool counted) {
  return Guess(facts, counted).run();
}

}  // namespace surfcast::scan
