// option_files FOLDER: writes what the viewer and the Python client have of the table of picture fields to FOLDER.
// option_files document FILE: brings the table of options in FILE, a document in Markdown, up to date.
// option_files compare FILE: fails if that would change FILE.
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <string>

#include "base/atomic_file.h"
#include "protocol/option_files/option_texts.h"

namespace surfcast::protocol {
namespace {

std::string read(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// A file that has the text already is left as it is, so that nothing is built anew of it.
Status write(const std::filesystem::path& path, const std::string& text) {
  return read(path) == text ? Status() : write_file_atomically(path, text);
}

Status write_files(const std::filesystem::path& folder) {
  if (Status status = write(folder / "plain_options.ts", typescript_options()); !status) return status;
  return write(folder / "plain_options.py", python_options());
}

Status write_document(const std::string& path) {
  const Result<std::string> text = with_options(read(path));
  return text ? write(path, *text) : fail(text);
}

Status compare_document(const std::string& path) {
  const std::string document = read(path);
  const Result<std::string> text = with_options(document);
  if (!text) return fail(text);
  if (*text == document) return {};
  return fail(ErrorKind::kInvalidInput, path +
                                            ": the table of options is not that of protocol/picture_fields.cpp; "
                                            "`option_files document " +
                                            path + "` brings it up to date");
}

Status run(const std::string& command, const std::string& path) {
  if (command == "document") return write_document(path);
  return command == "compare" ? compare_document(path) : write_files(command);
}

}  // namespace
}  // namespace surfcast::protocol

int main(int count, char** arguments) {
  if (count < 2) {
    std::cerr << "usage: option_files FOLDER | document FILE | compare FILE\n";
    return 2;
  }
  const surfcast::Status status = surfcast::protocol::run(arguments[1], count > 2 ? arguments[2] : "");
  if (!status) std::cerr << "option_files: " << status.error().message << '\n';
  return status ? 0 : 1;
}
