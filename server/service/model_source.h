#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "base/result.h"
#include "model/model_file.h"

namespace surfcast::service {

/// What a user is told about a model.
struct ModelDescription {
  model::ModelInfo info;
  uint32_t levels = 0;
  uint32_t blocks = 0;
  double spacing = 0;  ///< typical distance of neighbouring surfels of the source, world units
};

/// The models that are served, by name. Safe to call from several threads at once; may touch the disk.
class ModelSource {
 public:
  virtual ~ModelSource() = default;

  /// Sorted.
  [[nodiscard]] virtual std::vector<std::string> names() const = 0;
  [[nodiscard]] virtual Result<ModelDescription> describe(const std::string& name) const = 0;
  /// The model of that name; the pointer changes when its file does.
  [[nodiscard]] virtual Result<std::shared_ptr<const model::ModelFile>> open(const std::string& name) const = 0;
};

}  // namespace surfcast::service
