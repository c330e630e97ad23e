#pragma once

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <memory>
#include <utility>
#include <vector>

#include "model/model_file.h"
#include "render/renderer.h"

namespace surfcast::bench {

template <typename T>
T value_or_exit(Result<T> result) {
  if (result) return std::move(*result);
  std::fprintf(stderr, "%s\n", result.error().message.c_str());
  std::exit(1);
}

inline double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

/// Processor time of all threads of this process, milliseconds. It is less sensitive to other load on the machine than
/// wall time, and on software GL it is the cost of a frame.
inline double processor_ms() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) * 1e3 + static_cast<double>(t.tv_nsec) * 1e-6;
}

inline std::shared_ptr<const model::ModelFile> open_or_exit(const std::filesystem::path& path) {
  return std::make_shared<const model::ModelFile>(value_or_exit(model::ModelFile::open(path)));
}

inline picture::Frame draw_or_exit(render::Renderer& renderer, const std::shared_ptr<const model::ModelFile>& model,
                                   const picture::PictureRequest& request) {
  const std::atomic<bool> never{false};
  return value_or_exit(renderer.draw(model, request, never));
}

/// Milliseconds of a frame without the stages that depend on which blocks were resident.
inline double drawing_ms(const picture::Frame& frame) {
  double sum = 0;
  for (const picture::StageTime& stage : frame.stats.stages) {
    if (stage.name != "load" && stage.name != "decode" && stage.name != "upload") sum += stage.milliseconds;
  }
  return sum;
}

/// The picture of a view at rest.
inline picture::PictureRequest request_at_rest(const geometry::Camera& camera, int width, int height) {
  picture::PictureRequest request;
  request.camera = camera;
  request.width = width;
  request.height = height;
  request.spacing = 1;
  request.silhouettes = true;
  return request;
}

}  // namespace surfcast::bench
