#include "base/disk_folder.h"

#include "base/positioned_file.h"

namespace surfcast {

Result<std::vector<std::byte>> DiskFolder::read(const std::string& name, uint64_t most) const {
  const std::filesystem::path relative(name);
  if (relative.is_absolute() || name.find("..") != std::string::npos || name.find('\0') != std::string::npos) {
    return fail(ErrorKind::kInvalidInput, "names a file outside of its folder");
  }
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(folder_ / relative, ignored)) {
    return fail(ErrorKind::kNotFound, "names a file that is not there: " + name);
  }
  const Result<PositionedFile> file = PositionedFile::open(folder_ / relative);
  if (!file) return fail(file);
  if (file->size() > most) return fail(ErrorKind::kLimit, name + ": has more than " + std::to_string(most) + " bytes");
  std::vector<std::byte> bytes(file->size());
  if (const Status read = file->read(0, bytes); !read) return fail_about(name, read);
  return bytes;
}

}  // namespace surfcast
