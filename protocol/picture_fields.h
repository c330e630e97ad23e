#pragma once

#include <span>
#include <string_view>

#include "base/result.h"
#include "surfcast.pb.h"

namespace surfcast::protocol {

/// A part of a picture request as people name and write it. The same table serves flags of the command line
/// (`--camera-view-up` is "view_up", `--resolution` is "resolution"), environment variables and queries of HTTP.
struct PictureField {
  std::string_view name;  ///< as in a query
  std::string_view flag;  ///< as on the command line, without dashes
  std::string_view form;  ///< what a value looks like
  std::string_view help;
  bool several = false;  ///< a value may be several, joined by ';'; the flag may then be given several times
};

/// All of them, in the order of the help text.
std::span<const PictureField> picture_fields();

/// Sets one field from its text. The error says what the value should look like; an unknown name is kNotFound.
Status set_picture_field(wire::DrawPicture& picture, std::string_view name, std::string_view text);

/// Sets the pixel of a pick from "X,Y".
Status set_pixel(wire::PickSurfel& pick, std::string_view text);

/// "png", "jpg" and so on, as in the extension of a file's name.
Result<wire::FileFormat> parse_file_format(std::string_view text);
/// Name of a file format in lower case: "jpeg".
std::string_view name_of(wire::FileFormat format);
/// MIME type of a file format: "image/jpeg".
std::string_view media_type(wire::FileFormat format);

}  // namespace surfcast::protocol
