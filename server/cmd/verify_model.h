#pragma once

#include "base/result.h"
#include "model/model_file.h"

namespace surfcast {

/// Checks the checksum of every block and decodes it, on all threads. The failure is the first one in file order.
Status verify_model(const ModelFile& model);

}  // namespace surfcast
