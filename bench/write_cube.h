#pragma once

#include <charconv>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <iostream>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <oneapi/tbb/parallel_for.h>

#include "base/atomic_file.h"

namespace surfcast::bench {

/// A cube of samples that is generated into a file, plane after plane.
template <typename Sample>
struct GeneratedCube {
  std::function<std::string(uint64_t side)> header;  ///< of the file, in front of the samples
  std::function<Sample(uint64_t i, uint64_t j, uint64_t k, uint64_t side)> sample;
};

template <typename Sample>
Status write_cube(const GeneratedCube<Sample>& cube, uint64_t side, const char* path) {
  Result<AtomicFile> file = AtomicFile::create(path);
  if (!file) return fail(file);
  const std::string header = cube.header(side);
  Status status = file->append(std::as_bytes(std::span(header)));
  std::vector<Sample> plane(side * side);
  for (uint64_t k = 0; k < side && status; ++k) {
    oneapi::tbb::parallel_for(uint64_t{0}, side, [&](uint64_t j) {
      for (uint64_t i = 0; i < side; ++i) plane[j * side + i] = cube.sample(i, j, k, side);
    });
    status = file->append(std::as_bytes(std::span(plane)));
  }
  return status ? file->commit() : status;
}

/// A program with the arguments SIDE FILE.nrrd. Returns its exit code.
template <typename Sample>
int run_cube_program(const char* name, std::span<char* const> arguments, const GeneratedCube<Sample>& cube) {
  const std::string_view text = arguments.size() == 3 ? arguments[1] : "";
  uint64_t side = 0;
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), side);
  if (code != std::errc() || end != text.data() + text.size() || side == 0) {
    std::cerr << "usage: " << name << " SIDE FILE.nrrd\n";
    return 2;
  }
  const Status status = write_cube(cube, side, arguments[2]);
  if (status) return 0;
  std::cerr << name << ": " << status.error().message << "\n";
  return 1;
}

}  // namespace surfcast::bench
