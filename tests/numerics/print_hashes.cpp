// Draws all sample pictures, with models in the given folder, and prints their hashes, so that a test can compare the
// pictures of another process.

#include <cstdio>
#include <filesystem>

#include "model/write_model.h"
#include "numerics/sample_pictures.h"
#include "render/renderer.h"

int main(int argc, char** argv) {
  using namespace surfcast;
  if (argc != 2) return 2;
  Result<std::unique_ptr<render::Renderer>> renderer = render::Renderer::create({});
  if (!renderer) return 1;
  for (const testing::SamplePicture& sample : testing::sample_pictures()) {
    const std::filesystem::path path = std::filesystem::path(argv[1]) / (sample.name + ".surf");
    if (!model::write_model(sample.cloud, path, {})) return 1;
    Result<model::ModelFile> model = model::ModelFile::open(path);
    if (!model) return 1;
    const std::atomic<bool> cancelled{false};
    const Result<picture::Frame> frame =
        (*renderer)->draw(std::make_shared<const model::ModelFile>(std::move(*model)), sample.request, cancelled);
    if (!frame) return 1;
    std::printf("%s %016llx\n", sample.name.c_str(), static_cast<unsigned long long>(testing::hash_of(frame->image)));
  }
  return 0;
}
