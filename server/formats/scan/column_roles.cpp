#include "scan/column_roles.h"

#include <algorithm>
#include <map>
#include <utility>

#include "scan/column_names.h"
#include "scan/text_tokens.h"

namespace surfcast::scan {
namespace {

/// Columns by canonical name. A second column of the same name gets a name of its own.
using NamedColumns = std::map<std::string, size_t>;

std::string unused_name(const NamedColumns& taken, const std::string& wanted) {
  std::string name = wanted;
  for (int suffix = 2; name.empty() || taken.contains(name); ++suffix) name = wanted + "_" + std::to_string(suffix);
  return name;
}

NamedColumns name_columns(std::span<const ColumnInfo> columns, const std::vector<bool>& absent) {
  NamedColumns named;
  for (size_t i = 0; i < columns.size(); ++i) {
    if (!absent.empty() && absent[i]) continue;
    // Names appear in messages and JSON, which do not accept arbitrary bytes.
    const std::string given = printable(columns[i].name);
    std::string name = canonical_attribute_name(given);
    if (name.empty() || named.contains(name)) name = unused_name(named, given);
    named.emplace(std::move(name), i);
  }
  return named;
}

std::optional<size_t> take(NamedColumns& named, const char* name) {
  const auto it = named.find(name);
  if (it == named.end()) return std::nullopt;
  const size_t column = it->second;
  named.erase(it);
  return column;
}

/// Removes and returns three columns if all three exist.
std::optional<ColumnTriple> take_triple(NamedColumns& named, const char* a, const char* b, const char* c) {
  if (!named.contains(a) || !named.contains(b) || !named.contains(c)) return std::nullopt;
  return ColumnTriple{*take(named, a), *take(named, b), *take(named, c)};
}

void take_packed_color(std::span<const ColumnInfo> columns, NamedColumns& named, ColumnRoles& roles) {
  for (const char* name : {"rgb", "rgba"}) {
    const auto it = named.find(name);
    if (it == named.end() || size_of(columns[it->second].type) != sizeof(uint32_t)) continue;
    roles.packed_color = take(named, name);
    roles.packed_alpha = columns[*roles.packed_color].name.size() == 4 && !named.contains("alpha");
    return;
  }
}

}  // namespace

Status check_column_count(uint64_t columns) {
  if (columns <= kMaxColumns) return {};
  return fail(ErrorKind::kLimit, "has more than " + std::to_string(kMaxColumns) + " values for each point");
}

Result<ColumnRoles> assign_roles(std::span<const ColumnInfo> columns, const std::vector<bool>& absent) {
  if (Status status = check_column_count(columns.size()); !status) return fail(status);
  NamedColumns named = name_columns(columns, absent);
  const auto position = take_triple(named, "x", "y", "z");
  if (!position) return fail(ErrorKind::kInvalidInput, "has no x, y and z for its points");
  ColumnRoles roles;
  roles.position = *position;
  roles.normal = take_triple(named, "nx", "ny", "nz");
  roles.radius = take(named, "radius");
  roles.color = take_triple(named, "red", "green", "blue");
  if (!roles.color) take_packed_color(columns, named, roles);
  for (auto& [name, column] : named) roles.scalars.push_back({column, name});
  std::sort(roles.scalars.begin(), roles.scalars.end(),
            [](const auto& a, const auto& b) { return a.column < b.column; });
  return roles;
}

}  // namespace surfcast::scan
