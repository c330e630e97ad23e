#pragma once

#include <memory>
#include <string>

#include "base/file_folder.h"
#include "base/result.h"
#include "object_store/http_client.h"
#include "object_store/object_url.h"

namespace surfcast::object_store {

/// Objects of a store whose names begin alike, each of which is read whole by one request. Those that were announced
/// by `prefetch` are requested at once, several at a time; what arrives waits in memory until it is read. Objects that
/// were written after the first answer are those of another edition of the folder: reading them fails with kReplaced.
class RemoteFolder : public FileFolder {
 public:
  /// `url`: ends with a slash, or has the part of a query behind it, which is that of all objects. The client must
  /// outlive the folder.
  RemoteFolder(const HttpClient& client, std::string url);
  ~RemoteFolder() override;

  [[nodiscard]] Result<std::vector<std::byte>> read(const std::string& name, uint64_t most) const override;
  void prefetch(std::span<const std::string> names) const override;
  void forget(const std::string& name) const override;
  [[nodiscard]] bool replaced() const override;

 private:
  class State;
  std::shared_ptr<State> state_;
};

}  // namespace surfcast::object_store
