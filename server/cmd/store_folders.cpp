#include "cmd/store_folders.h"

#include <filesystem>
#include <map>

#include "base/log.h"
#include "base/repeat.h"
#include "object_store/object_url.h"

namespace surfcast::cmd {

Status StoreFolders::list() {
  std::map<std::string, std::filesystem::path> models;
  for (const std::string& url : urls_) {
    const Result<std::vector<std::string>> found = store_.list(url);
    if (!found) return fail(found);
    for (const std::string& model : *found) models.emplace(object_store::object_name(model), model);
  }
  const size_t count = models.size();
  if (models_.set_stored(std::move(models))) spdlog::info("folders of stores: {} models", count);
  return {};
}

void StoreFolders::watch(std::chrono::milliseconds interval) {
  thread_ = std::jthread([this, interval](const std::stop_token& stop) { keep_listing(stop, interval); });
}

/// The catalogue opens those anew that have been replaced.
void StoreFolders::look_for_replaced(const std::stop_token& stop) const {
  for (const std::shared_ptr<const model::ModelFile>& model : models_.opened_in_stores()) {
    if (stop.stop_requested()) return;
    if (model->source().replaced()) continue;
    model->source().look_for_replacement();
    if (model->source().replaced()) spdlog::info("{}: was replaced in its store", model->source().name());
  }
}

void StoreFolders::keep_listing(const std::stop_token& stop, std::chrono::milliseconds interval) {
  bool failed = false;
  repeat(stop, interval, [&] {
    const Status listed = list();
    if (!listed && !failed) spdlog::warn("{}; the models found there before are kept", listed.error().message);
    failed = !listed;
    look_for_replaced(stop);
  });
}

}  // namespace surfcast::cmd
