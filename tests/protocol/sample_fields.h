#pragma once

#include <string>

#include "protocol/picture_fields.h"

namespace surfcast::protocol {

/// A text of a plain field that is not its default: the last choice, the middle of a range.
inline std::string sample_text(const PictureField& field) {
  const NumberRange& range = field.value.range;
  switch (field.value.kind) {
    case FieldKind::kChoice:
      return std::string(field.form.substr(field.form.rfind('|') + 1));
    case FieldKind::kSwitch:
      return "on";
    case FieldKind::kNumber:
      return range.most < 1e300 ? std::to_string((range.least + range.most) / 2) : std::to_string(range.least + 1.5);
    case FieldKind::kColor:
      return "1,2,255";
    case FieldKind::kStructured:
      break;
  }
  return {};
}

/// A text that is no value of a plain field.
inline std::string wrong_text(const PictureField& field) {
  const NumberRange& range = field.value.range;
  switch (field.value.kind) {
    case FieldKind::kNumber:
      return range.above ? std::to_string(range.least) : std::to_string(range.least - 0.1);
    case FieldKind::kColor:
      return "256,0,0";
    default:
      return "none of them";
  }
}

}  // namespace surfcast::protocol
