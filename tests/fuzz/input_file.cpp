#include "fuzz/input_file.h"

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include <unistd.h>

namespace surfcast::fuzz {
namespace {

namespace fs = std::filesystem;

/// In memory where the system has such a folder.
fs::path make_folder() {
  const fs::path parent = fs::is_directory("/dev/shm") ? fs::path("/dev/shm") : fs::temp_directory_path();
  fs::path folder = parent / ("surfcast_fuzz_" + std::to_string(getpid()));
  fs::create_directories(folder);
  return folder;
}

struct Folder {
  fs::path path = make_folder();
  ~Folder() {
    std::error_code ignored;
    fs::remove_all(path, ignored);
  }
};

}  // namespace

std::string input_file(Bytes bytes, const char* name) {
  static const Folder folder;
  const fs::path path = folder.path / name;
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  file.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  file.close();
  if (!file) std::abort();
  return path.string();
}

}  // namespace surfcast::fuzz
