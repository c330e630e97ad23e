#pragma once

#include <span>
#include <string_view>

#include "base/result.h"
#include "surfcast.pb.h"

namespace surfcast::protocol {

/// A field of a picture request in text form. One table defines the command line flags (`--camera-view-up` sets
/// "view_up", `--resolution` sets "resolution"), the environment variables and the HTTP query parameters.
struct PictureField {
  std::string_view name;  ///< name of the query parameter
  std::string_view flag;  ///< name of the command line flag, without leading dashes
  std::string_view form;  ///< format of a value
  std::string_view help;
  bool several = false;  ///< takes a list separated by ';'; the flag may be repeated
  bool file = false;     ///< only where a picture file is written: not a flag of views and picks
};

/// All fields, in the order of the help text.
std::span<const PictureField> picture_fields();

/// Sets one field from its text. The error states the expected format; an unknown name is kNotFound.
Status set_picture_field(wire::DrawPicture& picture, std::string_view name, std::string_view text);

/// Sets the pixel of a pick request from "X,Y".
Status set_pixel(wire::PickSurfel& pick, std::string_view text);

/// Parses a file name extension: "png", "jpg" and so on.
Result<wire::FileFormat> parse_file_format(std::string_view text);
/// Name of a file format in lower case: "jpeg".
std::string_view name_of(wire::FileFormat format);
/// MIME type of a file format: "image/jpeg".
std::string_view media_type(wire::FileFormat format);

}  // namespace surfcast::protocol
