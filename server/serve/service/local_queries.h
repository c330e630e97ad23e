#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include "base/result.h"
#include "kinds/kind_table.h"
#include "kinds/source_block.h"
#include "model/model_file.h"
#include "service/model_queries.h"

namespace surfcast::service {

/// The query of a picture, for all its pixels. Reads no blocks.
Result<kinds::PickQuery> query_of(const model::ModelFile& model, const SurfaceQuery& picture);

/// Answers in this process. Keeps as many bytes of decoded blocks for later picks, and as many for later searches, so
/// that these do not drive out those of picks.
std::unique_ptr<ModelQueries> local_queries(size_t block_bytes, kinds::KindTable kinds = kinds::built_in_kinds());

}  // namespace surfcast::service
