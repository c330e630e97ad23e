#include "gaussian/sog_files.h"

#include <memory>
#include <utility>

#include <zip.h>

#include "scan/text_tokens.h"

namespace surfcast::gaussian {
namespace {

constexpr size_t kPart = size_t{1} << 16;

struct Discard {
  void operator()(zip_t* archive) const { zip_discard(archive); }
  void operator()(zip_file_t* file) const { zip_fclose(file); }
};

using ArchivePtr = std::shared_ptr<zip_t>;

tl::unexpected<Error> zip_error(const std::string& what, zip_error_t* error) {
  const std::string why = zip_error_strerror(error);
  zip_error_fini(error);
  return fail(ErrorKind::kInvalidInput, what + ": " + why);
}

/// Pictures are compressed already, and a description shrinks to a third. More is an attack.
uint64_t most_unpacked(uint64_t packed) {
  return 16 * packed + (uint64_t{1} << 20);
}

using EntryPtr = std::unique_ptr<zip_file_t, Discard>;

/// Reads to the end. Memory grows with what is read, not with what the archive states.
Result<std::vector<std::byte>> read_to_end(zip_file_t* file, uint64_t most, const scan::DecodingLimit& limit) {
  std::vector<std::byte> bytes;
  for (;;) {
    const size_t before = bytes.size();
    bytes.resize(before + kPart);
    const zip_int64_t read = zip_fread(file, bytes.data() + before, kPart);
    if (read < 0) return fail(ErrorKind::kInvalidInput, zip_file_strerror(file));
    bytes.resize(before + static_cast<size_t>(read));
    if (read == 0) return bytes;
    if (Status status = limit.check(bytes.size()); !status) return fail(status);
    if (bytes.size() > most) return fail(ErrorKind::kLimit, "unpacks to far more than it is packed");
  }
}

Result<std::vector<std::byte>> read_entry(zip_t* archive, const std::string& name, const scan::DecodingLimit& limit) {
  const zip_int64_t found = zip_name_locate(archive, name.c_str(), ZIP_FL_NODIR);
  if (found < 0) return fail(ErrorKind::kNotFound, "the archive has no file " + scan::printable(name));
  const auto index = static_cast<zip_uint64_t>(found);
  zip_stat_t information;
  const EntryPtr file(zip_fopen_index(archive, index, 0));
  const bool sized = zip_stat_index(archive, index, 0, &information) == 0 && (information.valid & ZIP_STAT_COMP_SIZE);
  if (!file || !sized) return fail(ErrorKind::kInvalidInput, scan::printable(name) + ": " + zip_strerror(archive));
  Result<std::vector<std::byte>> bytes = read_to_end(file.get(), most_unpacked(information.comp_size), limit);
  if (!bytes) return fail_about(scan::printable(name), bytes);
  return bytes;
}

bool is_plain_name(const std::filesystem::path& name) {
  return !name.empty() && name.filename() == name && name != "." && name != "..";
}

}  // namespace

FetchFile files_in_folder(std::filesystem::path folder) {
  return [folder = std::move(folder)](const std::string& name) -> Result<std::vector<std::byte>> {
    if (!is_plain_name(name)) {
      return fail(ErrorKind::kInvalidInput, "names a file that is not in its folder: " + scan::printable(name));
    }
    const Result<MappedFile> file = MappedFile::open(folder / name);
    if (!file) return fail(file);
    return std::vector<std::byte>(file->bytes().begin(), file->bytes().end());
  };
}

Result<FetchFile> files_in_zip(const stream::FilePtr& archive, const scan::DecodingLimit& limit) {
  zip_error_t error;
  zip_error_init(&error);
  const auto bytes = archive->bytes();
  zip_source_t* source = zip_source_buffer_create(bytes.data(), bytes.size(), 0, &error);
  if (source == nullptr) return zip_error("damaged archive", &error);
  zip_t* opened = zip_open_from_source(source, ZIP_RDONLY, &error);
  if (opened == nullptr) {
    zip_source_free(source);
    return zip_error("damaged archive", &error);
  }
  // The archive reads from the mapped file, which must live as long.
  const ArchivePtr shared(opened, [archive](zip_t* zip) { zip_discard(zip); });
  return FetchFile([shared, limit](const std::string& name) { return read_entry(shared.get(), name, limit); });
}

}  // namespace surfcast::gaussian
