#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "base/result.h"
#include "model/model_file.h"

namespace surfcast::service {

/// The description of a model for users.
struct ModelDescription {
  model::ModelInfo info;
  uint32_t levels = 0;
  uint32_t blocks = 0;
  double spacing = 0;  ///< typical distance between neighbouring surfels of the source, world units
};

/// The served models, by name. Thread-safe; methods may access the disk.
class ModelSource {
 public:
  virtual ~ModelSource() = default;

  /// The names of all models, sorted.
  [[nodiscard]] virtual std::vector<std::string> names() const = 0;
  [[nodiscard]] virtual Result<ModelDescription> describe(const std::string& name) const = 0;
  /// The model of this name. The pointer changes when the file is replaced.
  [[nodiscard]] virtual Result<std::shared_ptr<const model::ModelFile>> open(const std::string& name) const = 0;
};

}  // namespace surfcast::service
