#pragma once

#include "base/result.h"
#include "model/model_file.h"

namespace surfcast::cmd {

/// Checks the checksum of every block and decodes it, on all threads. The failure is the first one in file order.
Status verify_model(const model::ModelFile& model);

}  // namespace surfcast::cmd
