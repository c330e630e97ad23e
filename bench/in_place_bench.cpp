// in_place_bench FILE [BLOCKS] [ROUNDS]: measures the cost of making blocks of a COPC file, a folder of EPT or one of
// Potree 2 of this machine, on one core, with the decoding of their points. The blocks are evenly spread over the tree.
// Each round opens the file anew. Prints the sum over the blocks of their least processor time in any round.

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <vector>

#include "base/disk_folder.h"
#include "base/file_source.h"
#include "bench_support.h"
#include "point_tree/open_in_place.h"

namespace surfcast::bench {
namespace {

model::ModelFile open_tree_or_exit(const std::filesystem::path& file) {
  const auto format = point_tree::tree_format_of(file.string());
  if (!format) {
    std::fprintf(stderr, "%s: not the file that describes an octree of points\n", file.c_str());
    std::exit(1);
  }
  auto source = std::make_unique<const FileSource>(value_or_exit(PositionedFile::open(file)), file);
  auto folder = std::make_unique<const DiskFolder>(file.parent_path());
  return value_or_exit(point_tree::open_in_place(*format, std::move(source), std::move(folder), {}, nullptr));
}

/// The cost of a block so far.
struct MadeBlock {
  double milliseconds = std::numeric_limits<double>::infinity();
  size_t surfels = 0;
};

void make_blocks(const std::filesystem::path& file, std::vector<MadeBlock>& made) {
  const model::ModelFile model = open_tree_or_exit(file);
  for (size_t i = 0; i < made.size(); ++i) {
    const double start = processor_ms();
    made[i].surfels = value_or_exit(model.decode(i * model.blocks().size() / made.size())).size();
    made[i].milliseconds = std::min(made[i].milliseconds, processor_ms() - start);
  }
}

}  // namespace
}  // namespace surfcast::bench

int main(int argc, char** argv) {
  using namespace surfcast::bench;
  if (argc < 2 || argc > 4) {
    std::fprintf(stderr, "usage: in_place_bench FILE [BLOCKS] [ROUNDS]\n");
    return 2;
  }
  const size_t all = open_tree_or_exit(argv[1]).blocks().size();
  const size_t wanted = std::clamp<size_t>(argc > 2 ? std::strtoul(argv[2], nullptr, 10) : 50, 1, all);
  const unsigned long rounds = argc > 3 ? std::strtoul(argv[3], nullptr, 10) : 5;
  std::vector<MadeBlock> made(wanted);
  for (unsigned long round = 0; round < rounds; ++round) make_blocks(argv[1], made);
  double milliseconds = 0;
  size_t surfels = 0;
  for (const MadeBlock& block : made) {
    milliseconds += block.milliseconds;
    surfels += block.surfels;
  }
  std::printf("%zu blocks of %zu surfels together: %.0f ms, %.2f us each\n", wanted, surfels, milliseconds,
              1000 * milliseconds / static_cast<double>(surfels));
  return 0;
}
