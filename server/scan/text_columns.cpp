#include "scan/text_columns.h"

#include <array>
#include <cmath>

namespace surfcast {
namespace {

/// What is true of all values of a column.
struct ColumnFacts {
  bool integers = true;
  double min = INFINITY;
  double max = -INFINITY;

  void include(double value) {
    integers = integers && std::trunc(value) == value;
    // NaN is below and above everything, and so no colour.
    min = value >= min ? min : value;
    max = value <= max ? max : value;
  }
  [[nodiscard]] bool may_be_color() const { return min >= 0 && ((integers && max <= 65535) || max <= 1); }
  [[nodiscard]] bool is_opaque() const { return min == 255 && max == 255; }
};

std::vector<ColumnFacts> find_facts(const TextTable& table) {
  std::vector<ColumnFacts> facts(table.columns);
  for (size_t i = 0; i < table.values.size(); ++i) facts[i % table.columns].include(table.values[i]);
  return facts;
}

/// Unit vectors in every row, as well as decimals state them; or zero, but not everywhere.
bool is_normal(const TextTable& table, size_t column) {
  bool any = false;
  for (size_t i = column; i < table.values.size(); i += table.columns) {
    const double* n = &table.values[i];
    const double squared = n[0] * n[0] + n[1] * n[1] + n[2] * n[2];
    if (squared == 0) continue;
    if (!(std::abs(squared - 1) < 0.02)) return false;
    any = true;
  }
  return any;
}

bool is_color(const std::vector<ColumnFacts>& facts, size_t column) {
  return facts[column].may_be_color() && facts[column + 1].may_be_color() && facts[column + 2].may_be_color();
}

/// Names columns from the fourth on, left to right.
class Guess {
 public:
  explicit Guess(const TextTable& table) : table_(table), facts_(find_facts(table)) {}

  std::vector<std::string> run() {
    while (names_.size() < table_.columns) {
      const size_t left = table_.columns - names_.size();
      const bool single_first = left % 3 == 1 && !single_is_last();
      if (!single_first && left >= 3 && !has_normal_ && is_normal(table_, names_.size())) {
        add({"nx", "ny", "nz"}, has_normal_);
      } else if (!single_first && left >= 3 && !has_color_ && is_color(facts_, names_.size())) {
        add({"red", "green", "blue"}, has_color_);
      } else {
        names_.push_back(single_name());
      }
    }
    return std::move(names_);
  }

 private:
  /// Whether the odd column stands behind a colour: see the header.
  [[nodiscard]] bool single_is_last() const {
    const size_t at = names_.size();
    if (table_.counted || has_color_ || table_.columns - at != 4 || !is_color(facts_, at)) return false;
    const ColumnFacts& last = facts_[at + 3];
    return last.is_opaque() || !last.may_be_color();
  }

  std::string single_name() {
    const size_t at = names_.size();
    if (has_color_ && at + 1 == table_.columns && facts_[at].is_opaque()) return "alpha";
    if (!has_intensity_ && !has_color_ && (table_.columns - at) % 3 == 1) {
      has_intensity_ = true;
      return "intensity";
    }
    return "column_" + std::to_string(at + 1);
  }

  void add(const std::array<const char*, 3>& triple, bool& has) {
    names_.insert(names_.end(), triple.begin(), triple.end());
    has = true;
  }

  const TextTable& table_;
  std::vector<ColumnFacts> facts_;
  std::vector<std::string> names_ = {"x", "y", "z"};
  bool has_normal_ = false;
  bool has_color_ = false;
  bool has_intensity_ = false;
};

}  // namespace

std::vector<std::string> guess_column_names(const TextTable& table) {
  return Guess(table).run();
}

}  // namespace surfcast
