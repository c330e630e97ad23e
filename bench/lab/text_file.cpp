#include "lab/text_file.h"

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <sstream>

namespace surfcast::lab {

std::string content_of(const std::filesystem::path& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

void write_or_exit(const std::filesystem::path& path, const std::string& content) {
  if (std::ofstream(path) << content) return;
  std::fprintf(stderr, "%s: cannot be written\n", path.c_str());
  std::exit(1);
}

}  // namespace surfcast::lab
