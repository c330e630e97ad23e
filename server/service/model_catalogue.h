#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "base/result.h"
#include "model/model_file.h"
#include "service/model_source.h"

namespace surfcast::service {

/// A model file and the name it is served under.
struct NamedModel {
  std::string name;
  std::filesystem::path path;
  std::shared_ptr<const void> in_use{};  ///< held for as long as the file may be opened: whoever keeps it from removal
};

/// Model files by name: individual files, and the current content of folders ("NAME.surf"). An individual file hides a
/// file of the same name in a folder, and an earlier folder hides a later one. A file is opened at the first request,
/// and again after it has been replaced.
class ModelCatalogue : public ModelSource {
 public:
  ModelCatalogue(std::vector<NamedModel> files, std::vector<std::filesystem::path> folders)
      : files_(std::move(files)), folders_(std::move(folders)) {}

  [[nodiscard]] std::vector<std::string> names() const override;
  [[nodiscard]] Result<ModelDescription> describe(const std::string& name) const override;
  [[nodiscard]] Result<std::shared_ptr<const model::ModelFile>> open(const std::string& name) const override;

 private:
  struct Opened {
    std::filesystem::path path;
    std::filesystem::file_time_type written;
    std::shared_ptr<const model::ModelFile> model;
  };

  [[nodiscard]] std::map<std::string, std::filesystem::path> find_all() const;

  std::vector<NamedModel> files_;
  std::vector<std::filesystem::path> folders_;
  mutable std::mutex mutex_;
  mutable std::map<std::string, Opened> opened_;  ///< by name
};

}  // namespace surfcast::service
