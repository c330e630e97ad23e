// build_in_parts SCAN MODEL POINTS: `surfcastd build` for tests, in parts of so many points. The program itself cuts
// no scan into parts that a test could be quick with.

#include <array>
#include <cstdlib>
#include <filesystem>
#include <iostream>

#include "base/unfinished_file.h"
#include "builder/build_model.h"

int main(int argc, char** argv) {
  using namespace surfcast;
  if (argc != 4) return 2;
  remove_unfinished_files_on_signals();
  builder::BuildOptions options;
  options.part_points = std::strtoull(argv[3], nullptr, 10);
  const std::array<std::filesystem::path, 1> scans{argv[1]};
  const Result<builder::BuildReport> report =
      builder::build_model(scans, argv[2], options, [](const builder::BuildStep&) {});
  if (!report) {
    std::cerr << "build_in_parts: " << report.error().message << '\n';
    return 1;
  }
  std::cout << report->parts << " parts\n";
  return 0;
}
