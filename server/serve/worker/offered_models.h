#pragma once

#include <cstdint>
#include <map>
#include <memory>

#include "base/result.h"
#include "model/model_file.h"
#include "worker/messages.h"

namespace surfcast::worker {

/// A model that the server has offered, or why it does not open.
using OfferedModel = Result<std::shared_ptr<const model::ModelFile>>;
/// By the server's number.
using OfferedModels = std::map<uint64_t, OfferedModel>;

/// The models of an offer as one. The error of the first that does not open.
OfferedModel joined_model(const OfferJoin& offer, const OfferedModels& models);

}  // namespace surfcast::worker
