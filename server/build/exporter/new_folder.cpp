#include "exporter/new_folder.h"

#include <cerrno>
#include <cstring>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <unistd.h>

#include "base/atomic_file.h"
#include "base/descriptor.h"

namespace surfcast::exporter {

namespace fs = std::filesystem;

NewFolder::NewFolder(fs::path folder, ScratchFolder scratch)
    : folder_(std::move(folder)), scratch_(std::move(scratch)), unfinished_(scratch_.path() / "folder") {}

Result<NewFolder> NewFolder::create(const fs::path& target) {
  const fs::path folder = target.parent_path();
  std::error_code ignored;
  if (folder.filename().empty() || (fs::exists(folder, ignored) && !fs::is_empty(folder, ignored))) {
    return fail(ErrorKind::kInvalidInput,
                target.string() + ": name a new folder for it, like scan/" + target.filename().string());
  }
  const fs::path parent = folder.parent_path().empty() ? "." : folder.parent_path();
  const std::string prefix = ".surfcast-" + folder.filename().string() + "-";
  remove_abandoned_folders(parent, prefix);
  Result<ScratchFolder> scratch = ScratchFolder::create(parent, prefix);
  if (!scratch) return fail(scratch);
  NewFolder made(folder, std::move(*scratch));
  std::error_code code;
  fs::create_directory(made.unfinished_, code);
  if (code) return made.failed("cannot create", code.message());
  return made;
}

tl::unexpected<Error> NewFolder::failed(const char* what, const std::string& why) const {
  return fail(ErrorKind::kIo, folder_.string() + ": " + what + ": " + why);
}

Status NewFolder::make_folder(const std::string& name) const {
  std::error_code code;
  fs::create_directory(unfinished_ / name, code);
  return code ? failed("cannot create", code.message()) : Status();
}

Status NewFolder::write(const std::string& name, std::span<const std::byte> bytes) const {
  Result<AtomicFile> file = AtomicFile::create(unfinished_ / name);
  Status status = file ? file->append(bytes) : Status(fail(file));
  return status ? file->commit_unflushed() : status;
}

Status NewFolder::put_in_place() const {
  const Descriptor folder(::open(unfinished_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (folder.get() < 0 || ::syncfs(folder.get()) != 0) return failed("cannot flush", std::strerror(errno));
  std::error_code code;
  fs::rename(unfinished_, folder_, code);
  return code ? failed("cannot rename into place", code.message()) : Status();
}

}  // namespace surfcast::exporter
