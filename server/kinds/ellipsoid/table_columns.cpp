#include "ellipsoid/table_columns.h"

#include <algorithm>
#include <initializer_list>
#include <string_view>

#include "scan/column_names.h"

namespace surfcast::ellipsoid {
namespace {

using Names = std::vector<std::string>;

/// The columns of these names, or none if one is missing.
std::vector<size_t> find_all(const Names& keys, const std::vector<std::string>& wanted) {
  std::vector<size_t> columns;
  for (const std::string& name : wanted) {
    const auto found = std::find(keys.begin(), keys.end(), name);
    if (found == keys.end()) return {};
    columns.push_back(static_cast<size_t>(found - keys.begin()));
  }
  return columns;
}

/// The first of several spellings that is there: each a prefix and what follows it.
std::vector<size_t> find_first(const Names& keys, std::initializer_list<const char*> prefixes,
                               std::initializer_list<Names> endings) {
  for (const Names& ending : endings) {
    for (const char* prefix : prefixes) {
      Names wanted;
      for (const std::string& end : ending) wanted.push_back(prefix + end);
      if (std::vector<size_t> columns = find_all(keys, wanted); !columns.empty()) return columns;
    }
  }
  return {};
}

std::vector<size_t> find_semi_axes(const Names& keys) {
  const auto axes = {Names{"1", "2", "3"}, Names{"0", "1", "2"}, Names{"a", "b", "c"}, Names{"x", "y", "z"}};
  std::vector<size_t> columns = find_first(keys, {"semiaxis", "semi", "axis", "radius"}, axes);
  if (columns.empty()) columns = find_first(keys, {"r"}, {Names{"x", "y", "z"}, Names{"1", "2", "3"}});
  return columns.empty() ? find_all(keys, {"a", "b", "c"}) : columns;
}

}  // namespace

std::vector<size_t> ShapeRoles::all() const {
  std::vector<size_t> columns;
  for (const auto* part : {&semi_axes, &quaternion, &matrix, &tensor}) {
    columns.insert(columns.end(), part->begin(), part->end());
  }
  return columns;
}

std::optional<ShapeRoles> shape_roles(const Names& names) {
  Names keys;
  std::transform(names.begin(), names.end(), std::back_inserter(keys), scan::attribute_key);
  ShapeRoles roles;
  roles.semi_axes = find_semi_axes(keys);
  if (roles.semi_axes.empty()) {
    roles.tensor = find_first(keys, {"t", "d", "tensor", ""}, {Names{"xx", "xy", "xz", "yy", "yz", "zz"}});
    return roles.tensor.empty() ? std::nullopt : std::optional(roles);
  }
  roles.quaternion = find_first(keys, {"q", "rot", "rotation", "quat", "quaternion"},
                                {Names{"w", "x", "y", "z"}, Names{"0", "1", "2", "3"}});
  if (!roles.quaternion.empty()) return roles;
  roles.matrix = find_first(keys, {"r", "rot", "rotation", "m"},
                            {Names{"00", "01", "02", "10", "11", "12", "20", "21", "22"},
                             Names{"11", "12", "13", "21", "22", "23", "31", "32", "33"}});
  return roles;
}

}  // namespace surfcast::ellipsoid
