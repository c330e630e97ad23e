#pragma once

#include <glm/vec3.hpp>
#include <optional>
#include <string>
#include <vector>

#include "access/authorization.h"
#include "net/uploads.h"
#include "service/model_source.h"
#include "service/render_service.h"
#include "surfcast.pb.h"
#include "view/view_session.h"

namespace surfcast::net {

// Messages of the wire and values of the service, both ways.

/// The job that a request asks for, once it has been checked; what it leaves out gets its default. `model`: the one
/// that it names.
Result<service::PictureJob> to_job(const wire::DrawPicture& request, const access::AuthorizedModel& model);

Result<service::PickJob> to_job(const wire::PickSurfel& request, const access::AuthorizedModel& model);

Result<service::ProfileJob> to_job(const wire::GetProfile& request, const access::AuthorizedModel& model);

Result<service::PointsJob> to_job(const wire::GetPoints& request, const access::AuthorizedModel& model);

void to_wire(const service::ProfileResult& result, wire::Profile& message);
void to_wire(const std::optional<service::PickedPoint>& picked, wire::PickResult& message);
/// Takes the bytes out of the picture.
void to_wire(service::EncodedPicture picture, wire::Picture& message);
/// Takes the bytes out of the message.
void to_wire(view::ViewMessage message, wire::ViewFrame& frame);
void to_wire(const service::ModelList& list, const UploadConfig& uploads, wire::ModelList& message);
void to_wire(const std::string& name, const service::ModelDescription& description, wire::ModelDescription& message);

/// MIME type of a file format.
std::string media_type(picture::FileFormat format);

inline void to_wire(const glm::dvec3& v, wire::Vector3* message) {
  message->set_x(v.x);
  message->set_y(v.y);
  message->set_z(v.z);
}

}  // namespace surfcast::net
