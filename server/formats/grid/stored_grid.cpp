#include "grid/stored_grid.h"

#include <algorithm>
#include <utility>

#include "base/ascii_text.h"
#include "grid/header_text.h"
#include "grid/number_text.h"
#include "scan/text_tokens.h"
#include "stream/bzip2_stream.h"
#include "stream/inflate_stream.h"

namespace surfcast::grid {
namespace {

using stream::FilePtr;
using stream::StreamPtr;

tl::unexpected<Error> truncated(uint64_t has, uint64_t wanted) {
  return fail(ErrorKind::kInvalidInput, "truncated: holds at most " + std::to_string(has) + " of " +
                                            std::to_string(wanted) + " bytes of samples");
}

/// The end of the given number of lines.
Result<uint64_t> skip_lines(const FilePtr& file, uint64_t offset, uint64_t lines) {
  const auto bytes = file->bytes();
  for (uint64_t i = 0; i < lines; ++i) {
    const auto rest = bytes.subspan(offset);
    const auto end = std::find(rest.begin(), rest.end(), std::byte{'\n'});
    if (end == rest.end()) return fail(ErrorKind::kInvalidInput, "truncated: ends within the lines to skip");
    offset += static_cast<uint64_t>(end - rest.begin()) + 1;
  }
  return offset;
}

/// Stored bytes as they are, from where they begin.
Result<StreamPtr> open_raw(const StoredSamples& samples, const FilePtr& file, uint64_t offset, uint64_t share) {
  const uint64_t rest = file->bytes().size() - offset;
  const uint64_t skip = samples.byte_skip < 0 ? rest - std::min(share, rest) : static_cast<uint64_t>(samples.byte_skip);
  if (skip > rest || rest - skip < share) return truncated(rest - std::min(rest, skip), share);
  return std::make_unique<stream::MappedStream>(file, offset + skip, share);
}

StreamPtr unpacked(Packing packing, StreamPtr packed) {
  if (packing == Packing::kBzip2) return std::make_unique<stream::Bzip2Stream>(std::move(packed));
  if (packing == Packing::kInflate) return std::make_unique<stream::InflateStream>(std::move(packed));
  return packed;
}

/// The samples of one file.
Result<StreamPtr> open_share(const StoredSamples& samples, const FilePtr& file, uint64_t share) {
  const Result<uint64_t> offset = skip_lines(file, samples.offset, samples.line_skip);
  if (!offset) return fail(offset);
  if (samples.packing == Packing::kRaw) return open_raw(samples, file, *offset, share);
  if (samples.byte_skip < 0) {
    return fail(ErrorKind::kUnsupported, "a byte skip of -1 is for raw data only");
  }
  StreamPtr stream = unpacked(samples.packing, std::make_unique<stream::MappedStream>(file, *offset));
  if (Status skipped = stream->skip(static_cast<uint64_t>(samples.byte_skip)); !skipped) return fail(skipped);
  if (samples.packing == Packing::kText) {
    stream = std::make_unique<NumberText>(std::move(stream), samples.type, share / scan::size_of(samples.type));
  }
  if (stream->at_most() < share) return truncated(stream->at_most(), share);
  return stream;
}

/// The samples of several files, each opened in its turn.
class FileChain final : public stream::ByteStream {
 public:
  FileChain(StoredSamples samples, uint64_t share) : samples_(std::move(samples)), share_(share) {}

  Result<size_t> read(std::span<std::byte> out) override {
    size_t done = 0;
    while (done < out.size() && (left_ > 0 || next_ < samples_.files)) {
      if (left_ == 0) {
        if (Status status = open_next(); !status) return fail(status);
      }
      const std::span part = out.subspan(done, std::min<uint64_t>(out.size() - done, left_));
      if (Status status = stream::read_exactly(*current_, part); !status) return named(status.error());
      done += part.size();
      left_ -= part.size();
      if (left_ > 0) continue;
      if (Status status = stream::check_end(*current_); !status) return named(status.error());
    }
    return done;
  }

  [[nodiscard]] uint64_t at_most() const override { return left_ + (samples_.files - next_) * share_; }

 private:
  Status open_next() {
    current_path_ = samples_.name(next_);
    Result<FilePtr> file = stream::open_shared(current_path_);
    if (!file) return fail(file);
    Result<StreamPtr> stream = open_share(samples_, *file, share_);
    if (!stream) return named(stream.error());
    current_ = std::move(*stream);
    left_ = share_;
    ++next_;
    return {};
  }

  [[nodiscard]] tl::unexpected<Error> named(const Error& error) const {
    return fail(error.kind, current_path_.filename().string() + ": " + error.message);
  }

  StoredSamples samples_;
  uint64_t share_;
  uint64_t next_ = 0;
  uint64_t left_ = 0;
  StreamPtr current_;
  std::filesystem::path current_path_;
};

/// The share of a file. Values are not divided between files.
Result<uint64_t> share_of(const StoredSamples& samples) {
  const uint64_t share = samples.files == 0 ? 0 : samples.bytes / samples.files;
  if (share == 0 || share * samples.files != samples.bytes || share % scan::size_of(samples.type) != 0) {
    return fail(ErrorKind::kInvalidInput,
                "the samples cannot be divided among " + std::to_string(samples.files) + " data files");
  }
  return share;
}

/// Every file must be there, and those of raw data must be large enough. Ends at the first that is missing, so that the
/// number of files that a header states costs nothing.
Status check_files(const StoredSamples& samples, uint64_t share) {
  for (uint64_t i = 0; i < samples.files; ++i) {
    const std::filesystem::path path = samples.name(i);
    std::error_code code;
    const uint64_t size = std::filesystem::file_size(path, code);
    if (code) return fail(ErrorKind::kNotFound, "the data file " + path.filename().string() + ": " + code.message());
    if (samples.packing == Packing::kRaw && size < share) {
      return fail(ErrorKind::kInvalidInput, path.filename().string() + ": truncated: has " + std::to_string(size) +
                                                " of " + std::to_string(share) + " bytes of samples");
    }
  }
  return {};
}

}  // namespace

void store(StoredSamples samples, StoredGrid& grid) {
  if (!samples.file) {
    grid.data_files = samples.files;
    grid.data_file = samples.name;
  }
  grid.open = [samples = std::move(samples)] { return open_samples(samples); };
}

Result<StreamPtr> open_samples(const StoredSamples& samples) {
  if (samples.file) return open_share(samples, samples.file, samples.bytes);
  const Result<uint64_t> share = share_of(samples);
  if (!share) return fail(share);
  if (Status status = check_files(samples, *share); !status) return fail(status);
  return std::make_unique<FileChain>(samples, *share);
}

Result<std::filesystem::path> beside(const std::filesystem::path& header, std::string_view name) {
  const std::filesystem::path path(trimmed(name));
  const bool leaves = std::any_of(path.begin(), path.end(), [](const auto& part) { return part == ".."; });
  if (path.empty() || path.is_absolute() || leaves || name.find('\0') != std::string_view::npos) {
    return fail(ErrorKind::kInvalidInput,
                "names a data file that is not in its folder: " + scan::printable(trimmed(name)));
  }
  return header.parent_path() / path;
}

std::filesystem::path FilePattern::name(uint64_t i) const {
  const int64_t number = first + static_cast<int64_t>(i) * step;
  std::string digits = std::to_string(number < 0 ? -number : number);
  const std::string sign = number < 0 ? "-" : "";
  const size_t missing = static_cast<size_t>(width) - std::min<size_t>(width, digits.size() + sign.size());
  digits = zeros ? sign + std::string(missing, '0') + digits : std::string(missing, ' ') + sign + digits;
  return folder / (before + digits + after);
}

namespace {

/// Splits "name%03d.raw" at its conversion. The text is not given to printf, because it comes from a file.
std::optional<FilePattern> split_pattern(std::string_view text) {
  const size_t begin = text.find('%');
  const size_t end = text.find('d', begin == std::string_view::npos ? text.size() : begin);
  if (begin == std::string_view::npos || end == std::string_view::npos) return std::nullopt;
  FilePattern pattern;
  std::string_view width = text.substr(begin + 1, end - begin - 1);
  pattern.zeros = width.starts_with('0');
  if (!width.empty()) {
    const std::optional<uint64_t> digits = scan::parse_number<uint64_t>(width);
    if (!digits || *digits > 20) return std::nullopt;
    pattern.width = static_cast<int>(*digits);
  }
  pattern.before = text.substr(0, begin);
  pattern.after = text.substr(end + 1);
  return pattern;
}

}  // namespace

Result<std::optional<FilePattern>> parse_pattern(const std::filesystem::path& header, std::string_view text) {
  const std::vector<std::string_view> words = words_of(text);
  if (words.size() < 4) return std::nullopt;
  std::optional<FilePattern> pattern = split_pattern(words[0]);
  const auto first = scan::parse_number<int32_t>(words[1]);
  const auto last = scan::parse_number<int32_t>(words[2]);
  const auto step = scan::parse_number<int32_t>(words[3]);
  if (!pattern || !first || !last || !step) return std::nullopt;
  if (*step == 0 || (*step > 0) != (*last >= *first)) {
    return fail(ErrorKind::kInvalidInput, "the range of data files is empty: " + scan::printable(text));
  }
  const Result<std::filesystem::path> path = beside(header, words[0]);
  if (!path) return fail(path);
  pattern->folder = header.parent_path();
  pattern->first = *first;
  pattern->step = *step;
  pattern->count = static_cast<uint64_t>((int64_t{*last} - *first) / *step) + 1;
  return pattern;
}

}  // namespace surfcast::grid
