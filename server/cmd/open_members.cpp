#include "cmd/open_members.h"

#include <algorithm>
#include <memory>
#include <set>
#include <system_error>
#include <utility>

#include "access/joined_name.h"
#include "object_store/object_url.h"
#include "service/model_name.h"

namespace surfcast::cmd {
namespace fs = std::filesystem;

std::vector<fs::path> members_of_paths(std::span<const fs::path> paths) {
  std::vector<fs::path> all;
  for (const fs::path& path : paths) {
    std::error_code ignored;
    const bool whole = object_store::is_object_url(path.string()) || fs::exists(path, ignored);
    const std::vector<std::string> members = whole ? std::vector<std::string>() : access::members_of(path.string());
    if (members.empty()) all.push_back(path);
    all.insert(all.end(), members.begin(), members.end());
  }
  return all;
}

void set_apart(std::vector<std::string>& names) {
  std::set<std::string> taken;
  for (std::string& own : names) {
    std::ranges::replace(own, access::kJoin, '_');
    std::string name = own;
    for (int number = 2; !taken.insert(name).second; ++number) name = own + "_" + std::to_string(number);
    own = std::move(name);
  }
}

Result<model::ModelFile> open_model(const fs::path& path, const object_store::ObjectStore& store,
                                    const InPlaceOpener& in_place) {
  const std::string url = path.string();
  const bool stored = object_store::is_object_url(url);
  const std::string shown = stored ? object_store::shown_url(url) : url;
  if (in_place.opens(path)) return in_place.open(path, shown);
  return stored ? store.open(url, shown) : model::ModelFile::open(path);
}

Result<std::vector<model::Member>> open_members(std::span<const fs::path> paths, const object_store::ObjectStore& store,
                                                const InPlaceOpener& in_place) {
  std::vector<std::string> names;
  for (const fs::path& path : paths) {
    const bool stored = object_store::is_object_url(path.string());
    names.push_back(stored ? object_store::object_name(path.string()) : service::model_name(path));
  }
  set_apart(names);
  std::vector<model::Member> members;
  for (size_t i = 0; i < paths.size(); ++i) {
    Result<model::ModelFile> model = open_model(paths[i], store, in_place);
    if (!model) return fail(model);
    members.push_back({names[i], std::make_shared<const model::ModelFile>(std::move(*model))});
  }
  return members;
}

}  // namespace surfcast::cmd
