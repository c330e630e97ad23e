#include "protocol/framing.h"

#include <string>

#include <google/protobuf/message_lite.h>
#include <google/protobuf/stubs/logging.h>

#include "protocol/little_endian.h"

namespace surfcast::protocol {
namespace {

/// Protobuf writes a line to stderr for every message that it cannot decode. A peer must not be able to fill the log.
void silence_protobuf() {
  static const auto silenced = google::protobuf::SetLogHandler(nullptr);
  static_cast<void>(silenced);
}

}  // namespace

Result<size_t> frame_length(std::span<const std::byte, kFrameHeaderBytes> header, size_t limit) {
  const size_t length = load_u32(header.data());
  if (length <= limit) return length;
  return fail(ErrorKind::kLimit,
              "a message of " + std::to_string(length) + " bytes is larger than the limit of " + std::to_string(limit));
}

std::array<std::byte, kFrameHeaderBytes> frame_header(size_t length) {
  std::array<std::byte, kFrameHeaderBytes> header{};
  store_u32(header.data(), static_cast<uint32_t>(length));
  return header;
}

Result<std::vector<std::byte>> encode_message(const google::protobuf::MessageLite& message, size_t limit) {
  const size_t length = message.ByteSizeLong();
  if (length > limit) {
    return fail(ErrorKind::kLimit, "the answer of " + std::to_string(length) + " bytes is larger than the limit of " +
                                       std::to_string(limit));
  }
  std::vector<std::byte> bytes(length);
  message.SerializeWithCachedSizesToArray(reinterpret_cast<uint8_t*>(bytes.data()));
  return bytes;
}

Status decode_message(std::span<const std::byte> bytes, google::protobuf::MessageLite& message) {
  silence_protobuf();
  if (message.ParseFromArray(bytes.data(), static_cast<int>(bytes.size()))) return {};
  return fail(ErrorKind::kInvalidInput, "a message cannot be decoded");
}

void FrameSplitter::append(std::span<const std::byte> bytes) {
  buffer_.erase(buffer_.begin(), buffer_.begin() + static_cast<std::ptrdiff_t>(start_));
  start_ = 0;
  buffer_.insert(buffer_.end(), bytes.begin(), bytes.end());
}

Result<std::optional<std::vector<std::byte>>> FrameSplitter::next() {
  const std::span<const std::byte> rest = std::span(buffer_).subspan(start_);
  if (rest.size() < kFrameHeaderBytes) return std::nullopt;
  const Result<size_t> length = frame_length(rest.first<kFrameHeaderBytes>(), limit_);
  if (!length) return fail(length);
  if (rest.size() - kFrameHeaderBytes < *length) return std::nullopt;
  const std::span<const std::byte> content = rest.subspan(kFrameHeaderBytes, *length);
  start_ += kFrameHeaderBytes + *length;
  return std::vector<std::byte>(content.begin(), content.end());
}

}  // namespace surfcast::protocol
