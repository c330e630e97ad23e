// Draws all sample pictures, with models in the given folder, and prints their hashes, so that a test can compare the
// pictures of another process.

#include <cstdio>
#include <filesystem>

#include "model/write_model.h"
#include "numerics/sample_pictures.h"
#include "render/renderer.h"

namespace {

using namespace surfcast;

/// Draws a model, which `write` writes, and prints the hash of its picture. False if that fails.
template <typename Write>
bool print(render::Renderer& renderer, const std::string& name, const std::filesystem::path& path, const Write& write,
           const picture::PictureRequest& request) {
  if (!write(path)) return false;
  Result<model::ModelFile> model = model::ModelFile::open(path);
  if (!model) return false;
  const std::atomic<bool> cancelled{false};
  const Result<picture::Frame> frame =
      renderer.draw(std::make_shared<const model::ModelFile>(std::move(*model)), request, cancelled);
  if (!frame) return false;
  std::printf("%s %016llx\n", name.c_str(), static_cast<unsigned long long>(testing::hash_of(frame->image)));
  return true;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  const std::filesystem::path folder = argv[1];
  const Result<std::unique_ptr<render::Renderer>> renderer = render::Renderer::create({});
  if (!renderer) return 1;
  for (const testing::SamplePicture& sample : testing::sample_pictures()) {
    const auto write = [&](const std::filesystem::path& path) {
      return model::write_model(sample.cloud, path, {}).has_value();
    };
    if (!print(**renderer, sample.name, folder / (sample.name + ".surf"), write, sample.request)) return 1;
  }
  for (const testing::SampleMedium& sample : testing::sample_media()) {
    if (!print(**renderer, sample.name, folder / (sample.name + ".surf"), sample.build, sample.request)) return 1;
  }
  return 0;
}
