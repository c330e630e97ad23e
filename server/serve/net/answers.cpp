#include "net/answers.h"

#include <utility>

#include "net/convert.h"
#include "protocol/errors.h"
#include "protocol/framing.h"

namespace surfcast::net {
namespace {

Outcome failure(uint64_t id, const Error& error) {
  return {.answer = encode_error(id, error), .failed = true, .picture_bytes = 0, .stats = {}};
}

Outcome plain(const wire::Answer& answer) {
  return {.answer = encode_answer(answer), .failed = false, .picture_bytes = 0, .stats = {}};
}

}  // namespace

Bytes encode_error(uint64_t id, const Error& error) {
  wire::Answer answer;
  answer.set_id(id);
  protocol::to_wire(error, *answer.mutable_error());
  return *protocol::encode_message(answer, protocol::kMaxAnswerBytes);
}

Bytes encode_answer(const wire::Answer& answer) {
  Result<Bytes> bytes = protocol::encode_message(answer, protocol::kMaxAnswerBytes);
  return bytes ? std::move(*bytes) : encode_error(answer.id(), bytes.error());
}

Outcome outcome_of(uint64_t id, Result<service::EncodedPicture> picture) {
  if (!picture) return failure(id, picture.error());
  Outcome outcome;
  outcome.picture_bytes = picture->bytes.size();
  outcome.stats = picture->stats;
  outcome.memory = picture->memory;
  wire::Answer answer;
  answer.set_id(id);
  to_wire(std::move(*picture), *answer.mutable_picture());
  outcome.answer = encode_answer(answer);
  return outcome;
}

Outcome outcome_of(uint64_t id, const service::ModelList& models, const UploadConfig& uploads) {
  wire::Answer answer;
  answer.set_id(id);
  to_wire(models, uploads, *answer.mutable_model_list());
  return plain(answer);
}

Outcome outcome_of(uint64_t id, const Result<std::optional<service::PickedPoint>>& picked) {
  if (!picked) return failure(id, picked.error());
  wire::Answer answer;
  answer.set_id(id);
  to_wire(*picked, *answer.mutable_pick_result());
  return plain(answer);
}

Outcome outcome_of(uint64_t id, const Result<service::ProfileResult>& profile) {
  if (!profile) return failure(id, profile.error());
  wire::Answer answer;
  answer.set_id(id);
  to_wire(*profile, *answer.mutable_profile());
  return plain(answer);
}

Bytes encode_total(uint64_t id, uint64_t total, bool more) {
  wire::Answer answer;
  answer.set_id(id);
  answer.mutable_points()->set_total(total);
  answer.mutable_points()->set_more(more);
  return encode_answer(answer);
}

Bytes encode_piece(uint64_t id, const service::PointPiece& piece) {
  wire::Answer answer;
  answer.set_id(id);
  answer.mutable_points()->set_data(piece.bytes.data(), piece.bytes.size());
  answer.mutable_points()->set_more(!piece.last);
  return encode_answer(answer);
}

Outcome outcome_of(uint64_t id, const std::string& name, const Result<service::ModelDescription>& description) {
  if (!description) return failure(id, description.error());
  wire::Answer answer;
  answer.set_id(id);
  to_wire(name, *description, *answer.mutable_model_description());
  return plain(answer);
}

}  // namespace surfcast::net
