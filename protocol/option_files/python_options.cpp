#include "protocol/option_files/option_texts.h"

namespace surfcast::protocol {
namespace {

constexpr std::string_view kPythonHead =
    R"("""The options of pictures that are one value. Made by option_files from the table in protocol/picture_fields.cpp."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal, NamedTuple, TypedDict


class PlainOptions(TypedDict, total=False):
    """What a picture shows, and how: the options that are one value."""

)";

constexpr std::string_view kTable = R"(

class PlainField(NamedTuple):
    """How an option is kept in a message."""

    kind: Literal["choice", "switch", "number", "color"]
    place: str  # with '.' before members of members
    names: tuple[str, ...] = ()  # of a choice, in the order of their numbers
    above: float | None = None  # of a number whose message has 0 where it is not stated


PLAIN_FIELDS = {
)";

std::string quoted_names(std::string_view form) {
  std::string list;
  for (const std::string_view name : names_of_choice(form)) {
    list.append(list.empty() ? "\"" : ", \"").append(name).append("\"");
  }
  return list;
}

std::string python_type(const PictureField& field) {
  switch (field.value.kind) {
    case FieldKind::kChoice:
      return "Literal[" + quoted_names(field.form) + "]";
    case FieldKind::kSwitch:
      return "bool";
    case FieldKind::kColor:
      return "Sequence[int]";
    default:
      return "float";
  }
}

std::string python_value(const PictureField& field) {
  const std::string place = ", \"" + std::string(field.value.place) + "\"";
  switch (field.value.kind) {
    case FieldKind::kChoice:
      return "\"choice\"" + place + ", (" + quoted_names(field.form) + ")";
    case FieldKind::kSwitch:
      return "\"switch\"" + place;
    case FieldKind::kColor:
      return "\"color\"" + place;
    default:
      return "\"number\"" + place +
             (field.value.range.above && !field.value.may_be_absent ? ", above=" + number_text(field.value.range.least)
                                                                    : "");
  }
}

}  // namespace

std::string python_options() {
  std::string types;
  std::string table;
  for (const PictureField& field : picture_fields()) {
    if (field.value.kind == FieldKind::kStructured) continue;
    types += wrapped(field.help, "    # ", kLineWidth);
    types.append("    ").append(field.name).append(": ").append(python_type(field)).append("\n");
    table.append("    \"").append(field.name).append("\": PlainField(").append(python_value(field)).append("),\n");
  }
  return std::string(kPythonHead) + types + std::string(kTable) + table + "}\n";
}

}  // namespace surfcast::protocol
