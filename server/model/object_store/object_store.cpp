#include "object_store/object_store.h"

#include <algorithm>
#include <utility>

#include "object_store/http_client.h"
#include "object_store/listing.h"
#include "object_store/remote_folder.h"
#include "object_store/remote_source.h"

namespace surfcast::object_store {
namespace {

/// The query for a page of a list, its parts in the order that signatures want. Servers that list files ignore it.
std::string listing_query(const std::string& prefix, const std::string& next) {
  const std::string page = next.empty() ? std::string() : "continuation-token=" + encode_query(next) + "&";
  return "?" + page + "delimiter=%2F&list-type=2&prefix=" + encode_query(prefix);
}

}  // namespace

ObjectStore::ObjectStore(StoreConfig config, std::shared_ptr<model::BlockCache> cache)
    : config_(std::move(config)), cache_(std::move(cache)) {}
ObjectStore::~ObjectStore() = default;

Result<const HttpClient*> ObjectStore::client() const {
  const std::lock_guard lock(mutex_);
  if (!client_) {
    Result<std::unique_ptr<HttpClient>> started = HttpClient::start(config_);
    if (!started) return fail(started);
    client_ = std::move(*started);
  }
  return client_.get();
}

Result<std::unique_ptr<ByteSource>> ObjectStore::open_source(const std::string& url, const std::string& name) const {
  const Result<const HttpClient*> http = client();
  if (!http) return fail(http);
  const Result<StorePlace> place = place_of(url, config_);
  if (!place) return fail(place);
  return RemoteSource::open(**http, *place, name).map([](std::unique_ptr<RemoteSource> source) {
    return std::unique_ptr<ByteSource>(std::move(source));
  });
}

Result<std::unique_ptr<FileFolder>> ObjectStore::open_folder(const std::string& url) const {
  const Result<const HttpClient*> http = client();
  if (!http) return fail(http);
  const size_t query = std::min(shown_url(url).size(), url.size());
  const std::string path = url.substr(0, query);
  return std::make_unique<RemoteFolder>(**http, path.substr(0, path.rfind('/') + 1) + url.substr(query));
}

Result<model::ModelFile> ObjectStore::open(const std::string& url, const std::string& name) const {
  return open_source(url, name).and_then(
      [&](std::unique_ptr<ByteSource> source) { return model::ModelFile::open(std::move(source), cache_); });
}

Result<std::vector<std::string>> ObjectStore::list(const std::string& url) const {
  const Result<const HttpClient*> http = client();
  if (!http) return fail(http);
  const Result<StorePlace> place = folder_of(url, config_);
  if (!place) return fail(place);
  std::vector<std::string> models;
  uint64_t bytes_left = config_.listing_bytes;
  ListingPage page;
  do {
    HttpRequest request = (*http)->request(*place, listing_query(place->prefix, page.next));
    request.most_bytes = bytes_left;
    const Result<HttpAnswer> answer = (*http)->send_and_wait(std::move(request), check_whole_answer);
    if (!answer) return fail_about(url, answer);
    bytes_left -= answer->body.size();
    const auto* text = reinterpret_cast<const char*>(answer->body.data());
    Result<ListingPage> next = parse_listing({text, answer->body.size()}, place->prefix);
    if (!next) return fail_about(url, next);
    page = std::move(*next);
    for (const std::string& model : page.models) models.push_back(url + (place->s3 ? model : encode_path(model)));
  } while (!page.next.empty());
  return models;
}

}  // namespace surfcast::object_store
