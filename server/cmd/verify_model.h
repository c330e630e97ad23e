#pragma once

#include "base/result.h"
#include "kinds/kind_table.h"
#include "model/model_file.h"

namespace surfcast::cmd {

/// Checks the checksum of every block and decodes it, on all threads. The failure is the first one in file order.
/// Fails on blocks of a kind that is not in the table.
Status verify_model(const model::ModelFile& model, kinds::KindTable kinds = kinds::built_in_kinds());

}  // namespace surfcast::cmd
