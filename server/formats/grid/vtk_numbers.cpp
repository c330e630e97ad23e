#include "grid/vtk_numbers.h"

#include <memory>
#include <string>
#include <utility>

#include "grid/number_text.h"
#include "stream/base64_stream.h"

namespace surfcast::grid {

using stream::StreamPtr;

uint64_t StoredNumbers::bytes() const {
  return stream::saturating(values, scan::size_of(type), 0);
}

Result<StreamPtr> StoredNumbers::open() const {
  StreamPtr stream = std::make_unique<stream::MappedStream>(file, begin, size);
  if (text) return std::make_unique<NumberText>(std::move(stream), type, values);
  if (base64) stream = std::make_unique<stream::Base64Stream>(std::move(stream));
  if (!headed) return stream;
  return VtkBlockStream::open(std::move(stream), coding);
}

Result<std::optional<uint64_t>> StoredNumbers::in_file() const {
  if (text || base64 || coding.compressed) return std::nullopt;
  const Result<StreamPtr> stream = open();
  if (!stream) return fail(stream);
  if (Status status = check_holds(**stream, bytes()); !status) return fail(status);
  const uint64_t header = coding.wide ? sizeof(uint64_t) : sizeof(uint32_t);
  return begin + (headed ? header : 0);
}

Status check_holds(const stream::ByteStream& stream, uint64_t bytes) {
  if (stream.at_most() >= bytes) return {};
  return fail(ErrorKind::kInvalidInput, "truncated: holds at most " + std::to_string(stream.at_most()) + " of " +
                                            std::to_string(bytes) + " bytes");
}

}  // namespace surfcast::grid
