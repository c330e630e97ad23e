// block_bench MODEL [BLOCKS]: measures the cost of decoding blocks of a model and of packing them for the GPU, on one
// core. The blocks are evenly spread over the file. Prints mean processor milliseconds per block, without disk reads.

#include <algorithm>
#include <cstdio>
#include <cstdlib>

#include "bench_support.h"
#include "residency/packing.h"

namespace surfcast::bench {
namespace {

struct BlockCost {
  double decode_ms = 0;
  double pack_ms = 0;
  double attributes_ms = 0;
  size_t surfels = 0;
};

void measure(const model::ModelFile& model, size_t block, BlockCost& cost) {
  value_or_exit(model.decode(block));  // loads the bytes into memory
  const double start = processor_ms();
  const model::DecodedBlock decoded = value_or_exit(model.decode(block, model::WantedScalars::kNone));
  const double before_packing = processor_ms();
  residency::PackedSurfels packed = residency::pack_block(decoded, model.info().color_bits, model.info().oriented);
  const double before_attributes = processor_ms();
  residency::pack_attributes(decoded, packed);
  cost.attributes_ms += processor_ms() - before_attributes;
  cost.decode_ms += before_packing - start;
  cost.pack_ms += before_attributes - before_packing;
  cost.surfels += decoded.size();
}

}  // namespace
}  // namespace surfcast::bench

int main(int argc, char** argv) {
  using namespace surfcast::bench;
  if (argc < 2 || argc > 3) {
    std::fprintf(stderr, "usage: block_bench MODEL [BLOCKS]\n");
    return 2;
  }
  const auto model = open_or_exit(argv[1]);
  const size_t all = model->blocks().size();
  const size_t wanted = std::clamp<size_t>(argc > 2 ? std::strtoul(argv[2], nullptr, 10) : 200, 1, all);
  BlockCost cost;
  for (size_t i = 0; i < wanted; ++i) measure(*model, i * all / wanted, cost);
  const auto blocks = static_cast<double>(wanted);
  std::printf("%zu blocks of %.0f surfels: decode %.2f ms, pack %.2f ms, attributes %.2f ms\n", wanted,
              static_cast<double>(cost.surfels) / blocks, cost.decode_ms / blocks, cost.pack_ms / blocks,
              cost.attributes_ms / blocks);
  return 0;
}
