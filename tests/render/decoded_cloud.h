#pragma once

#include <gtest/gtest.h>

#include "model/model_file.h"
#include "surfel/surfel_cloud.h"

namespace surfcast::testing {

/// The surfels of the finest level as decoded from the file, for the reference renderer.
inline surfel::SurfelCloud decoded_cloud(const model::ModelFile& model) {
  surfel::SurfelCloud cloud;
  cloud.oriented = model.info().oriented;
  if (model.info().color_bits > 0) cloud.colors = surfel::ColorAttribute{model.info().color_bits, {}};
  for (size_t b = 0; b < model.blocks().size(); ++b) {
    if (model.blocks()[b].level != 0) continue;
    const Result<model::DecodedBlock> block = model.decode(b);
    if (!block) ADD_FAILURE() << block.error().message;
    for (size_t i = 0; i < block->size(); ++i) {
      cloud.positions.push_back(block->position(i));
      cloud.normals.push_back(block->normals[i]);
      cloud.radii.push_back(block->radii[i]);
      cloud.weights.push_back(block->weights[i]);
      cloud.scatter.push_back(block->is_scatter(i) ? 1 : 0);
      if (cloud.colors) cloud.colors->values.push_back(block->colors[i]);
    }
  }
  return cloud;
}

}  // namespace surfcast::testing
