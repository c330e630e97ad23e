#include <algorithm>
#include <vector>

#include "fuzz/input_file.h"
#include "fuzz/targets.h"
#include "gaussian/gaussian_block.h"
#include "kinds/kind_table.h"
#include "model/model_file.h"
#include "volume/brick_coding.h"

namespace surfcast::fuzz {
namespace {

/// Reads a byte that stands for a small number, and goes on behind it.
uint32_t small_number(Bytes& bytes, uint32_t most) {
  if (bytes.empty()) return 1;
  const auto number = static_cast<uint32_t>(bytes.front());
  bytes = bytes.subspan(1);
  return 1 + number % most;
}

}  // namespace

void read_model(Bytes bytes) {
  const Result<model::ModelFile> file = model::ModelFile::open(input_file(bytes, "input.surf"));
  if (!file) return;
  const kinds::KindTable kinds = kinds::built_in_kinds();
  const Result<std::vector<uint32_t>> numbers = kinds::find_kinds(*file, kinds);
  if (!numbers) return;
  for (uint32_t block = 0; block < file->blocks().size(); ++block) {
    const kinds::Kind& kind = *kinds[(*numbers)[file->blocks()[block].kind]];
    if (!kind.load(*file, block, true) || !kind.decode(*file, block)) return;
  }
}

void read_gaussian_block(Bytes bytes) {
  model::StoredBlock block;
  block.items = small_number(bytes, 255);
  block.extent = glm::u32vec3(65535);
  const std::vector<std::byte> content(bytes.begin(), bytes.end());
  block.bytes = content;
  static_cast<void>(gaussian::decode_gaussians(block));
}

void read_brick(Bytes bytes) {
  volume::BrickHeader place;
  for (int axis = 0; axis < 3; ++axis) place.count[axis] = small_number(bytes, volume::kBrickSamples);
  const std::vector<std::byte> content(bytes.begin(), bytes.end());
  static_cast<void>(volume::decode_brick(content, place));
}

}  // namespace surfcast::fuzz
