// laz_bench FILE.laz...: decodes files on one thread and prints points per second of processor time, median of five
// runs.

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <vector>

#include "base/mapped_file.h"
#include "laz/laz_file.h"
#include "scan/las_header.h"

namespace {

using namespace surfcast;

double processor_seconds() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + static_cast<double>(t.tv_nsec) * 1e-9;
}

Status decode_all(const laz::LazFile& file, std::vector<std::byte>& records) {
  for (const laz::Chunk& chunk : file.chunks()) {
    records.resize(chunk.count * file.record_length());
    Result<laz::LazChunkReader> reader = file.read_chunk(chunk);
    if (!reader) return fail(reader);
    if (Status status = reader->read(records); !status) return status;
  }
  return {};
}

Result<double> median_seconds(const laz::LazFile& file) {
  std::vector<double> seconds;
  std::vector<std::byte> records;
  for (int run = 0; run < 5; ++run) {
    const double start = processor_seconds();
    if (Status status = decode_all(file, records); !status) return fail(status);
    seconds.push_back(processor_seconds() - start);
  }
  std::nth_element(seconds.begin(), seconds.begin() + 2, seconds.end());
  return seconds[2];
}

Status measure(const char* path) {
  const Result<MappedFile> mapped = MappedFile::open(path);
  if (!mapped) return fail(mapped);
  const Result<scan::LasHeader> header = scan::parse_las_header(mapped->bytes());
  if (!header) return fail(header);
  const laz::LazPoints points = {header->point_format, header->record_length, header->count, header->data_offset};
  const Result<laz::LazFile> file = laz::LazFile::open(mapped->bytes(), points, header->laszip_record);
  if (!file) return fail(file);
  const Result<double> seconds = median_seconds(*file);
  if (!seconds) return fail(seconds);
  const auto count = static_cast<double>(header->count);
  std::printf("%s: format %d, %.0f points of %.1f coded bytes, %.3f s, %.2f million points per second\n", path,
              header->point_format, count, static_cast<double>(mapped->bytes().size()) / count, *seconds,
              count / *seconds / 1e6);
  return {};
}

}  // namespace

int main(int argc, char** argv) {
  for (int i = 1; i < argc; ++i) {
    if (const Status status = measure(argv[i]); !status) {
      std::fprintf(stderr, "laz_bench: %s: %s\n", argv[i], status.error().message.c_str());
      return 1;
    }
  }
  return 0;
}
