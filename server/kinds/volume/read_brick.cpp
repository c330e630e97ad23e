#include "volume/read_brick.h"

#include <utility>

#include "volume/brick_coding.h"
#include "volume/packing.h"

namespace surfcast::volume {

Result<Brick> read_brick(const model::ModelFile& model, uint32_t block) {
  const model::Part part = model.part(block);
  const Result<model::StoredBlock> stored = part.model.stored(part.block);
  if (!stored) return fail(stored);
  const model::BrickRecord record = part.model.brick(part.block);
  BrickHeader place;
  place.volume = record.volume;
  place.level = record.level;
  place.brick = record.brick;
  place.count = brick_count(part.model.volumes()[record.volume].size, record.level, record.brick);
  const auto wrong = [&](const char* what) { return fail(model.named(block, {ErrorKind::kInvalidInput, what})); };
  if (stored->items != brick_items(place.count)) return wrong("it has a wrong number of items");
  Result<Brick> brick = decode_brick(stored->bytes, place);
  if (!brick) return fail(model.named(block, brick.error()));
  if (brick->header.low < double{record.low} || brick->header.high > double{record.high}) {
    return wrong("it has values outside its range");
  }
  brick->header.volume += part.first_volume;
  return brick;
}

}  // namespace surfcast::volume
