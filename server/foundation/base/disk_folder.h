#pragma once

#include <filesystem>
#include <utility>

#include "base/file_folder.h"

namespace surfcast {

/// A folder of this machine. A name that leads out of it is an error.
class DiskFolder : public FileFolder {
 public:
  explicit DiskFolder(std::filesystem::path folder) : folder_(std::move(folder)) {}

  [[nodiscard]] Result<std::vector<std::byte>> read(const std::string& name, uint64_t most) const override;
  void prefetch(std::span<const std::string> /*names*/) const override {}
  void forget(const std::string& /*name*/) const override {}

 private:
  std::filesystem::path folder_;
};

}  // namespace surfcast
