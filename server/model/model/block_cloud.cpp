#include "model/block_cloud.h"

#include <utility>

namespace surfcast::model {

surfel::SurfelCloud cloud_of(DecodedBlock block, const ModelInfo& info) {
  surfel::SurfelCloud cloud;
  cloud.oriented = info.oriented;
  cloud.z_up = info.z_up;
  cloud.positions.reserve(block.size());
  for (size_t i = 0; i < block.size(); ++i) cloud.positions.push_back(block.position(i));
  cloud.normals = std::move(block.normals);
  cloud.radii = std::move(block.radii);
  cloud.weights = std::move(block.weights);
  cloud.scatter = std::move(block.scatter);
  if (info.color_bits != 0) cloud.colors = surfel::ColorAttribute{info.color_bits, std::move(block.colors)};
  cloud.scalars = std::move(block.scalars);
  cloud.sources = {{"", 0, cloud.size(), std::nullopt}};
  return cloud;
}

}  // namespace surfcast::model
