#pragma once

#include <functional>
#include <glm/vec3.hpp>
#include <optional>
#include <string_view>
#include <type_traits>

#include "protocol/parse.h"
#include "protocol/picture_fields.h"

namespace surfcast::protocol {

// The kinds of values in the table of picture fields. `Get`, `Set` and `Has` are the accessors of DrawPicture, or
// functions that stand for them where the value is a member of a member. `Member` is that of PlainOptions, or nullptr
// where the structures keep the value otherwise.

/// Where a field is, beside its accessors.
struct FieldPlace {
  std::string_view place;
  std::optional<std::string_view> viewer_default{};
};

// What needs no accessors.
std::optional<double> parse_number(const NumberRange& range, std::string_view text);
std::optional<bool> parse_switch(std::string_view text);
bool parse_color(std::string_view text, wire::Color& color);
Status check_choice(const PictureField& field, int number);
/// `stated`: the message could leave the value out, and did not. Otherwise 0 stands for a value that is not stated.
Status check_number(const PictureField& field, double number, bool stated);
Status check_color(const PictureField& field, const wire::Color& color);

template <auto Get>
using ValueOf = std::decay_t<std::invoke_result_t<decltype(Get), const wire::DrawPicture&>>;

template <auto Set>
constexpr FieldValue structured(std::string_view place) {
  return {.place = place, .parse = [](const PictureField&, wire::DrawPicture& picture, std::string_view text) {
            return std::invoke(Set, picture, text);
          }};
}

template <auto Get, auto Set, auto Member = nullptr>
constexpr FieldValue choice(const FieldPlace& place) {
  FieldValue value{.kind = FieldKind::kChoice, .place = place.place, .viewer_default = place.viewer_default};
  value.parse = [](const PictureField& field, wire::DrawPicture& picture, std::string_view text) {
    const std::optional<int> number = parse_choice(field.form, text);
    if (number) std::invoke(Set, picture, static_cast<ValueOf<Get>>(*number));
    return number.has_value();
  };
  value.check = [](const PictureField& field, const wire::DrawPicture& picture) {
    return check_choice(field, std::invoke(Get, picture));
  };
  if constexpr (!std::is_null_pointer_v<decltype(Member)>) {
    value.read = [](const wire::DrawPicture& picture, picture::PlainOptions& options) {
      options.*Member = static_cast<std::decay_t<decltype(options.*Member)>>(std::invoke(Get, picture));
    };
  }
  return value;
}

/// A switch that may be absent.
template <auto Set>
constexpr FieldValue toggle(const FieldPlace& place) {
  FieldValue value{.kind = FieldKind::kSwitch, .place = place.place, .may_be_absent = true};
  value.viewer_default = place.viewer_default;
  value.parse = [](const PictureField&, wire::DrawPicture& picture, std::string_view text) {
    const std::optional<bool> on = parse_switch(text);
    if (on) std::invoke(Set, picture, *on);
    return on.has_value();
  };
  value.check = [](const PictureField&, const wire::DrawPicture&) { return Status(); };
  return value;
}

/// A number. Without `Has` the message has 0 where it is not stated.
template <auto Get, auto Set, auto Member = nullptr, auto Has = nullptr>
constexpr FieldValue number(const NumberRange& range, const FieldPlace& place) {
  constexpr bool kMayBeAbsent = !std::is_null_pointer_v<decltype(Has)>;
  FieldValue value{.kind = FieldKind::kNumber, .place = place.place, .range = range, .may_be_absent = kMayBeAbsent};
  value.viewer_default = place.viewer_default;
  value.parse = [](const PictureField& field, wire::DrawPicture& picture, std::string_view text) {
    const std::optional<double> given = parse_number(field.value.range, text);
    if (given) std::invoke(Set, picture, *given);
    return given.has_value();
  };
  value.check = [](const PictureField& field, const wire::DrawPicture& picture) {
    if constexpr (kMayBeAbsent) {
      return std::invoke(Has, picture) ? check_number(field, std::invoke(Get, picture), true) : Status();
    } else {
      return check_number(field, std::invoke(Get, picture), false);
    }
  };
  if constexpr (!std::is_null_pointer_v<decltype(Member)>) {
    value.read = [](const wire::DrawPicture& picture, picture::PlainOptions& options) {
      if constexpr (kMayBeAbsent) {
        if (!std::invoke(Has, picture)) return;
      }
      options.*Member = std::invoke(Get, picture);
    };
  }
  return value;
}

template <auto Get, auto Mutable, auto Member>
constexpr FieldValue color(const FieldPlace& place) {
  FieldValue value{.kind = FieldKind::kColor, .place = place.place, .viewer_default = place.viewer_default};
  value.parse = [](const PictureField&, wire::DrawPicture& picture, std::string_view text) {
    wire::Color color;
    if (!parse_color(text, color)) return false;
    *std::invoke(Mutable, picture) = color;
    return true;
  };
  value.check = [](const PictureField& field, const wire::DrawPicture& picture) {
    return check_color(field, std::invoke(Get, picture));
  };
  value.read = [](const wire::DrawPicture& picture, picture::PlainOptions& options) {
    const wire::Color& color = std::invoke(Get, picture);
    options.*Member = glm::u8vec3(color.red(), color.green(), color.blue());
  };
  return value;
}

}  // namespace surfcast::protocol
