#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "net/uploads.h"
#include "service/model_source.h"
#include "service/render_service.h"
#include "surfcast.pb.h"

namespace surfcast::net {

/// One encoded message, without a length before it.
using Bytes = std::vector<std::byte>;

/// An answer as bytes, and what is to be counted. Made on the service's threads.
struct Outcome {
  Bytes answer;
  bool failed = false;
  size_t picture_bytes = 0;                  ///< encoded
  std::optional<picture::FrameStats> stats;  ///< of a picture
  std::shared_ptr<const void> memory{};      ///< counts the bytes of a picture
};

/// The bytes of an answer, or of the error that it is too large.
Bytes encode_answer(const wire::Answer& answer);
Bytes encode_error(uint64_t id, const Error& error);

Outcome outcome_of(uint64_t id, Result<service::EncodedPicture> picture);
Outcome outcome_of(uint64_t id, const service::ModelList& models, const UploadConfig& uploads);
Outcome outcome_of(uint64_t id, const Result<std::optional<service::PickedPoint>>& picked);
Outcome outcome_of(uint64_t id, const Result<service::ProfileResult>& profile);
/// The number of points in a region; `more`: they follow.
Bytes encode_total(uint64_t id, uint64_t total, bool more);
/// Some bytes of their file.
Bytes encode_piece(uint64_t id, const service::PointPiece& piece);

Outcome outcome_of(uint64_t id, const std::string& name, const Result<service::ModelDescription>& description);

}  // namespace surfcast::net
