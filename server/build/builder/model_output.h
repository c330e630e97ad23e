#pragma once

#include <filesystem>
#include <optional>
#include <utility>

#include "base/result.h"
#include "model/model_writer.h"

namespace surfcast::builder {

/// The model file of a build. Inputs of each kind add their blocks, one kind after another.
class ModelOutput {
 public:
  explicit ModelOutput(std::filesystem::path target) : target_(std::move(target)) {}

  [[nodiscard]] const std::filesystem::path& target() const { return target_; }
  /// The writer for the blocks of a kind. The first call creates the file; later ones add their schema
  /// (model::ModelWriter::add_schema).
  Result<model::ModelWriter*> writer(model::ModelSchema schema);
  /// Completes the file. writer() has been called.
  Result<model::WriteReport> finish();

 private:
  std::filesystem::path target_;
  std::optional<model::ModelWriter> writer_;
};

}  // namespace surfcast::builder
