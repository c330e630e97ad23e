// copy_scan INPUT OUTPUT: reads a scan once, writes the same bytes, flushes them, and prints points per second. This is
// the least work of any build, and thus a reference for its speed.

#include <algorithm>
#include <iostream>

#include "base/atomic_file.h"
#include "base/mapped_file.h"
#include "base/stopwatch.h"
#include "scan/las_header.h"

namespace {

using surfcast::AtomicFile;
using surfcast::MappedFile;
using surfcast::Result;
using surfcast::Status;

constexpr size_t kPiece = size_t{32} << 20;

Status copy(const MappedFile& input, const char* output) {
  Result<AtomicFile> file = AtomicFile::create(output);
  if (!file) return surfcast::fail(file);
  for (size_t at = 0; at < input.bytes().size(); at += kPiece) {
    const size_t size = std::min(kPiece, input.bytes().size() - at);
    if (Status status = file->append(input.bytes().subspan(at, size)); !status) return status;
    input.release_pages();
  }
  return file->commit();
}

Status run(const char* input, const char* output) {
  const surfcast::Stopwatch stopwatch;
  const Result<MappedFile> file = MappedFile::open(input);
  if (!file) return surfcast::fail(file);
  const Result<surfcast::scan::LasHeader> header = surfcast::scan::parse_las_header(file->bytes());
  if (!header) return surfcast::fail(header);
  if (Status status = copy(*file, output); !status) return status;
  std::cout << static_cast<double>(header->count) / stopwatch.seconds() << " points/s\n";
  return {};
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::cerr << "usage: copy_scan INPUT.las OUTPUT\n";
    return 2;
  }
  const Status status = run(argv[1], argv[2]);
  if (!status) std::cerr << "copy_scan: " << status.error().message << '\n';
  return status ? 0 : 1;
}
