#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "base/result.h"

namespace surfcast {

/// The files of a folder, each of which is read whole: on this machine, or the objects of a store. Names are relative.
/// Errors name the file. Safe to use from several threads at once.
class FileFolder {
 public:
  virtual ~FileFolder() = default;

  /// kLimit if the file has more bytes than `most`. Waits for a prefetch of it.
  [[nodiscard]] virtual Result<std::vector<std::byte>> read(const std::string& name, uint64_t most) const = 0;
  /// Begins to read files, each of which will be read soon, most urgent first. Returns at once.
  virtual void prefetch(std::span<const std::string> names) const = 0;
  /// A file that was prefetched will not be read.
  virtual void forget(const std::string& name) const = 0;
  /// True once reading has failed with kReplaced: files are newer than the folder was opened. It has to be opened anew.
  [[nodiscard]] virtual bool replaced() const { return false; }
};

}  // namespace surfcast
