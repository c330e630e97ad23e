#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <memory>
#include <mutex>
#include <optional>

#include "base/lru_cache.h"
#include "model/model_file.h"

namespace surfcast::crs {
class Transformation;
}

namespace surfcast::service {

/// Positions of models in the systems of their sources. The ways there are kept for the models used most recently.
/// Thread-safe.
class SourcePositions {
 public:
  SourcePositions();
  ~SourcePositions();
  SourcePositions(const SourcePositions&) = delete;
  SourcePositions& operator=(const SourcePositions&) = delete;

  /// None if the system of the model is that of its source, or unknown, or if there is no way from one to the other.
  std::optional<glm::dvec3> find(const model::ModelFile& model, const glm::dvec3& position);

 private:
  struct Way;
  static constexpr size_t kModels = 16;

  std::shared_ptr<const Way> way_of(const model::ModelFile& model);

  std::mutex mutex_;
  LruCache<uint64_t, Way> ways_{kModels};  ///< by ModelFile::id. The budget counts models
};

}  // namespace surfcast::service
