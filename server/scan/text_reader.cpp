#include "scan/text_reader.h"

#include <string>
#include <utility>
#include <vector>

#include "scan/narrow_scalars.h"
#include "scan/point_table.h"
#include "scan/text_columns.h"
#include "scan/text_table.h"
#include "scan/text_tokens.h"

namespace surfcast {

Result<ScanPoints> read_text(std::span<const std::byte> bytes) {
  std::string_view text = as_text(bytes);
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  if (text.starts_with(kByteOrderMark)) text.remove_prefix(kByteOrderMark.size());
  Result<TextTable> numbers = parse_text_table(text);
  if (!numbers) return fail(numbers.error());
  const std::vector<std::string> names = numbers->names.empty() ? guess_column_names(*numbers) : numbers->names;
  PointTable table;
  table.rows = numbers->rows();
  const auto* first = reinterpret_cast<const std::byte*>(numbers->values.data());
  for (size_t i = 0; i < names.size(); ++i) {
    table.columns.push_back(
        {names[i], ScalarType::kFloat64, first + i * sizeof(double), names.size() * sizeof(double), false});
  }
  table.storage.emplace_back(std::move(numbers->values));
  Result<ScanPoints> points = points_from_table(table);
  if (!points) return points;
  for (ScalarAttribute& scalar : points->scalars) scalar.values = narrow_scalars(std::move(scalar.values));
  return points;
}

}  // namespace surfcast
