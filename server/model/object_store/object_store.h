#pragma once

#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "base/byte_source.h"
#include "base/file_folder.h"
#include "base/result.h"
#include "model/model_file.h"
#include "object_store/store_config.h"

namespace surfcast::object_store {

class HttpClient;

/// Models on servers that answer requests for ranges, and in stores that speak S3. Outlives the models that it opened.
/// Thread-safe; methods wait for the network, at most as long as StoreConfig::timeout for each request.
class ObjectStore {
 public:
  /// `cache`: keeps blocks on this disk; may be null.
  explicit ObjectStore(StoreConfig config, std::shared_ptr<model::BlockCache> cache = nullptr);
  ~ObjectStore();
  ObjectStore(const ObjectStore&) = delete;
  ObjectStore& operator=(const ObjectStore&) = delete;

  /// Opens the model of a URL, which its errors call by `name`. Two requests: one for its beginning, one for its
  /// tables.
  [[nodiscard]] Result<model::ModelFile> open(const std::string& url, const std::string& name) const;
  /// An object of any kind. One request, for its beginning.
  [[nodiscard]] Result<std::unique_ptr<ByteSource>> open_source(const std::string& url, const std::string& name) const;
  /// The objects beside the one of a URL.
  [[nodiscard]] Result<std::unique_ptr<FileFolder>> open_folder(const std::string& url) const;
  /// The URLs of the models directly in a folder, whose URL ends with a slash.
  [[nodiscard]] Result<std::vector<std::string>> list(const std::string& url) const;

 private:
  [[nodiscard]] Result<const HttpClient*> client() const;

  const StoreConfig config_;
  const std::shared_ptr<model::BlockCache> cache_;
  mutable std::mutex mutex_;                    ///< guards client_
  mutable std::unique_ptr<HttpClient> client_;  ///< from the first use on
};

}  // namespace surfcast::object_store
