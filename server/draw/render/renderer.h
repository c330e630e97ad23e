#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/preemption.h"
#include "base/result.h"
#include "kinds/kind_table.h"
#include "model/model_file.h"
#include "picture/device_info.h"
#include "picture/picture.h"
#include "render/memory_budgets.h"

namespace surfcast::residency {
class LoadGuard;
}

namespace surfcast::render {

struct RendererConfig {
  int gpu = -1;                            ///< index of the EGL device; -1: the first hardware device, else software
  std::optional<size_t> gpu_bytes{};       ///< for the surfels of all models; none: default_budgets
  std::optional<size_t> host_bytes{};      ///< for packed blocks evicted from the GPU; none: default_budgets
  unsigned sharers = 1;                    ///< renderers that share the host's memory by default
  unsigned decoders = 0;                   ///< threads that decode blocks; 0: one for each core
  size_t upload_bytes = size_t{16} << 20;  ///< stored on the GPU for one picture in motion, which waits for it
  uint32_t motion_glyphs = 2;              ///< of a picture in motion, see most_glyphs
  size_t viewers = 64;                   ///< of one model whose motion is remembered; least recently seen are forgotten
  bool gpu_kernels = false;              ///< also draws software GL with the kernels for GPUs: for tests
  std::optional<size_t> list_entries{};  ///< of the tiles of a region, see docs/architecture.md; none: what fits
  bool surveys = true;           ///< false: what is not seen is drawn as finely as what is; for tests and measurements
  std::string shader_defines{};  ///< text before every shader, for programs that measure other kernels
  kinds::KindTable kinds = kinds::built_in_kinds();  ///< kinds of blocks that can be drawn; outlives the renderer
  residency::LoadGuard* load_guard = nullptr;        ///< is told of every block that is loaded; outlives the renderer
};

/// Draws pictures of models. Owns a GL context: create, use and destroy it on one thread.
class Renderer {
 public:
  static Result<std::unique_ptr<Renderer>> create(const RendererConfig& config);
  ~Renderer();

  /// Draws one picture. Blocks of the model stay resident for later pictures. Fails on an invalid camera or resolution,
  /// on blocks of an unknown kind, and on a damaged block that the picture waits for. Returns kCancelled soon after it
  /// is cancelled. More urgent work may draw one other picture at a time meanwhile, which may be interrupted once more.
  /// Such a picture uses other buffers between the passes, and does not evict the blocks of this one.
  Result<picture::Frame> draw(const std::shared_ptr<const model::ModelFile>& model,
                              const picture::PictureRequest& request, const Preemption& preemption);
  /// Releases the resident blocks of a model that will not be drawn again, once the current picture is complete.
  void release_model(const model::ModelFile& model);

  [[nodiscard]] const picture::DeviceInfo& device() const;
  /// The names of the shaders compiled so far, with the kinds other than surfels that they support.
  [[nodiscard]] std::vector<std::string> programs() const;
  /// Largest picture side in pixels that the device can draw.
  [[nodiscard]] int max_resolution() const;

 private:
  struct State;
  explicit Renderer(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace surfcast::render
