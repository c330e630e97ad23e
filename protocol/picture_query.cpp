#include "protocol/picture_query.h"

#include "protocol/picture_fields.h"
#include "protocol/url_query.h"
#include "protocol/validate.h"

namespace surfcast::protocol {

Result<wire::DrawPicture> parse_picture_query(std::string_view model, std::string_view query) {
  wire::DrawPicture picture;
  picture.set_model(std::string(model));
  Status status = for_each_parameter(query, [&picture](const std::string& name, const std::string& text) {
    return set_picture_field(picture, name, text);
  });
  if (status) status = check_picture(picture);
  if (!status) return fail(status);
  return picture;
}

Result<wire::PickSurfel> parse_pick_query(std::string_view model, std::string_view query) {
  wire::PickSurfel pick;
  pick.mutable_picture()->set_model(std::string(model));
  bool pixel_given = false;
  Status status = for_each_parameter(query, [&](const std::string& name, const std::string& text) {
    if (name != "pixel") return set_picture_field(*pick.mutable_picture(), name, text);
    pixel_given = true;
    return set_pixel(pick, text);
  });
  if (status && !pixel_given) status = fail(ErrorKind::kInvalidInput, "pixel: is missing");
  if (status) status = check_picture(pick.picture());
  if (!status) return fail(status);
  return pick;
}

}  // namespace surfcast::protocol
