#pragma once

#include <chrono>
#include <string>
#include <thread>
#include <vector>

#include "object_store/object_store.h"
#include "service/model_catalogue.h"

namespace surfcast::cmd {

/// Tells a catalogue which models are in folders of stores, and notices when those that are open are replaced. Store
/// and catalogue must outlive it.
class StoreFolders {
 public:
  StoreFolders(const object_store::ObjectStore& store, service::ModelCatalogue& models, std::vector<std::string> urls)
      : store_(store), models_(models), urls_(std::move(urls)) {}

  /// Lists all folders. Fails without a change if one cannot be listed.
  Status list();
  /// Lists them again after each interval, and looks for replaced models, in a thread of its own. A store that does not
  /// answer changes nothing.
  void watch(std::chrono::milliseconds interval);

 private:
  void keep_listing(const std::stop_token& stop, std::chrono::milliseconds interval);
  void look_for_replaced(const std::stop_token& stop) const;

  const object_store::ObjectStore& store_;
  service::ModelCatalogue& models_;
  const std::vector<std::string> urls_;
  std::jthread thread_;
};

}  // namespace surfcast::cmd
