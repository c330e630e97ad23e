#include "cmd/in_place_flags.h"

#include <system_error>
#include <utility>

#include "base/disk_folder.h"
#include "base/file_source.h"
#include "cmd/settings.h"
#include "object_store/object_url.h"
#include "protocol/request_flags.h"

namespace surfcast::cmd {

void add_in_place_flags(CLI::App& command, InPlaceOptions& options) {
  command
      .add_flag("--in-place", options.files,
                "Show scans that are octrees of points (COPC, EPT, Potree 2) as they are, without building a model; "
                "those of URLs "
                "are always shown so")
      ->envname(protocol::environment_name("in-place"));
  add_size(
      command, "hierarchy-limit", options.limits.hierarchy_bytes,
      "Hierarchy of an octree of points that is shown in place, 32 bytes a node (default 64M). More: memory; less: "
      "large scans are refused",
      {1024, uint64_t{1} << 40});
  add_size(
      command, "in-place-memory", options.limits.memory,
      "Points and blocks in memory of a scan that is shown in place (default 512M). More: memory; less: points are "
      "read and decoded again",
      {1 << 20, uint64_t{1} << 40});
}

namespace {

/// The file of this machine that is an octree of points, or describes it.
std::filesystem::path tree_file(const std::filesystem::path& path) {
  std::error_code ignored;
  if (!std::filesystem::is_directory(path, ignored)) return path;
  return path / (std::filesystem::exists(path / "ept.json", ignored) ? "ept.json" : "metadata.json");
}

}  // namespace

bool is_in_place(const std::filesystem::path& path, const InPlaceOptions& options) {
  if (object_store::is_object_url(path.string())) {
    const auto format = point_tree::tree_format_of(object_store::shown_url(path.string()));
    return format && format != point_tree::TreeFormat::kPotree2;
  }
  std::error_code ignored;
  const std::filesystem::path file = tree_file(path);
  return options.files && point_tree::tree_format_of(file.string()) && std::filesystem::exists(file, ignored);
}

Result<model::ModelFile> InPlaceOpener::open_stored(const std::string& url, const std::string& shown) const {
  Result<std::unique_ptr<FileFolder>> folder = store_->open_folder(url);
  if (!folder) return fail(folder);
  return store_->open_source(url, shown).and_then([&](std::unique_ptr<ByteSource> source) {
    return point_tree::open_in_place(*point_tree::tree_format_of(object_store::shown_url(url)), std::move(source),
                                     std::move(*folder), options_.limits, cache_);
  });
}

Result<model::ModelFile> InPlaceOpener::open(const std::filesystem::path& path, const std::string& shown) const {
  const std::string url = path.string();
  if (object_store::is_object_url(url)) {
    Result<model::ModelFile> model = open_stored(url, shown);
    // Replaced between two of the requests that opening takes.
    const bool again = !model && model.error().kind == ErrorKind::kReplaced;
    return again ? open_stored(url, shown) : std::move(model);
  }
  const std::filesystem::path described = tree_file(path);
  Result<PositionedFile> file = PositionedFile::open(described);
  if (!file) return fail(file);
  return point_tree::open_in_place(
      *point_tree::tree_format_of(described.string()), std::make_unique<const FileSource>(std::move(*file), described),
      std::make_unique<const DiskFolder>(described.parent_path()), options_.limits, cache_);
}

}  // namespace surfcast::cmd
