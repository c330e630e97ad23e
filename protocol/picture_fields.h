#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string_view>

#include "base/result.h"
#include "picture/plain_options.h"
#include "surfcast.pb.h"

namespace surfcast::protocol {

struct PictureField;

/// What the value of a field is. All kinds but kStructured are plain: one value, which the table describes completely.
enum class FieldKind : uint8_t { kStructured, kChoice, kSwitch, kNumber, kColor };

/// The numbers that a field may be.
struct NumberRange {
  double least = 0;
  double most = std::numeric_limits<double>::infinity();
  bool above = false;       ///< `least` itself is none of them
  std::string_view unit{};  ///< for error messages
};

/// How a field is kept in messages and in structures. Made by the functions of protocol/field_values.h.
struct FieldValue {
  FieldKind kind = FieldKind::kStructured;
  std::string_view place;  ///< in DrawPicture, with '.' before members of its members
  NumberRange range{};
  bool may_be_absent = false;  ///< the message tells an absent value from every other one
  /// The value of a link of the viewer that does not state the field; an empty text: none. Without one, links do not
  /// have the field, or the viewer keeps it in a structure.
  std::optional<std::string_view> viewer_default{};
  /// Stores the value of a text, or returns false and leaves the picture as it was.
  bool (*parse)(const PictureField& field, wire::DrawPicture& picture, std::string_view text) = nullptr;
  /// Of plain fields: whether the value of a message is one of the field.
  Status (*check)(const PictureField& field, const wire::DrawPicture& picture) = nullptr;
  /// Of fields that are members of PlainOptions: copies the value.
  void (*read)(const wire::DrawPicture& picture, picture::PlainOptions& options) = nullptr;
};

/// A field of a picture request. One table (picture_fields.cpp) defines the command line flags (`--camera-view-up` sets
/// "view_up", `--resolution` sets "resolution"), the environment variables and the HTTP query parameters; the checks of
/// messages and their conversion, the options of the Python client and of the viewer's links, as far as values are
/// plain; and the table of options in docs/pictures.md.
struct PictureField {
  std::string_view name;  ///< name of the query parameter
  std::string_view flag;  ///< name of the command line flag, without leading dashes
  std::string_view form;  ///< format of a value; of a choice: the names of its values in the order of their numbers
  std::string_view help;
  FieldValue value;
  bool several = false;  ///< takes a list separated by ';'; the flag may be repeated
  bool file = false;     ///< only where a picture file is written: not a flag of views and picks
};

/// All fields, in the order of the help text.
std::span<const PictureField> picture_fields();

/// Sets one field from its text. The error states the expected format; an unknown name is kNotFound.
Status set_picture_field(wire::DrawPicture& picture, std::string_view name, std::string_view text);

/// Checks the plain fields of a message.
Status check_plain_fields(const wire::DrawPicture& picture);

/// The plain options of a message that has been checked.
picture::PlainOptions plain_options(const wire::DrawPicture& picture);

/// Sets the pixel of a pick request from "X,Y".
Status set_pixel(wire::PickSurfel& pick, std::string_view text);

/// Parses a file name extension: "png", "jpg" and so on.
Result<wire::FileFormat> parse_file_format(std::string_view text);
/// Name of a file format in lower case: "jpeg".
std::string_view name_of(wire::FileFormat format);
/// MIME type of a file format: "image/jpeg".
std::string_view media_type(wire::FileFormat format);

}  // namespace surfcast::protocol
