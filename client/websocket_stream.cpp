#include "client/websocket_stream.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <random>
#include <utility>

#include "client/sha1.h"
#include "protocol/framing.h"

namespace surfcast::client {
namespace {

enum Opcode : uint8_t { kContinuation = 0, kBinary = 2, kClose = 8, kPing = 9, kPong = 10 };

constexpr uint8_t kLast = 0x80;    // in the first byte: last frame of its message
constexpr uint8_t kMasked = 0x80;  // in the second byte

struct Frame {
  uint8_t first = 0;  ///< kLast, reserved bits, opcode
  std::span<const std::byte> content;
};

void append_integer(std::vector<std::byte>& bytes, uint64_t value, int count) {
  for (int i = count - 1; i >= 0; --i) bytes.push_back(static_cast<std::byte>(value >> 8 * i & 0xff));
}

/// A frame of a client is masked, so that no proxy mistakes what a page sends for HTTP.
std::vector<std::byte> masked_frame(Opcode opcode, std::span<const std::byte> content, uint32_t mask) {
  std::vector<std::byte> bytes{static_cast<std::byte>(kLast | opcode)};
  const bool small = content.size() < 126;
  const bool medium = content.size() < 65536;
  bytes.push_back(static_cast<std::byte>(kMasked | (small ? content.size() : medium ? 126U : 127U)));
  if (!small) append_integer(bytes, content.size(), medium ? 2 : 8);
  append_integer(bytes, mask, 4);
  for (size_t i = 0; i < content.size(); ++i) {
    bytes.push_back(content[i] ^ static_cast<std::byte>(mask >> (24 - 8 * (i % 4)) & 0xff));
  }
  return bytes;
}

class WebSocketStream : public MessageStream {
 public:
  Bytes encode(std::span<const std::byte> message) override { return masked_frame(kBinary, message, new_mask()); }
  void append(std::span<const std::byte> bytes) override;
  Result<std::optional<Bytes>> next() override;
  Bytes take_replies() override { return std::exchange(replies_, {}); }

 private:
  Result<std::optional<Frame>> next_frame();
  Status take(const Frame& frame);
  Status take_piece(const Frame& frame);
  uint32_t new_mask() { return static_cast<uint32_t>(random_()); }

  std::random_device random_;
  Bytes buffer_;
  size_t start_ = 0;  ///< bytes of buffer_ that have been looked at
  Bytes message_;     ///< the frames of the message so far
  bool inside_message_ = false;
  bool whole_ = false;
  Bytes replies_;
};

void WebSocketStream::append(std::span<const std::byte> bytes) {
  buffer_.erase(buffer_.begin(), buffer_.begin() + static_cast<std::ptrdiff_t>(start_));
  start_ = 0;
  buffer_.insert(buffer_.end(), bytes.begin(), bytes.end());
}

/// The next frame that has arrived whole; it lies in buffer_.
Result<std::optional<Frame>> WebSocketStream::next_frame() {
  const std::span<const std::byte> rest = std::span(buffer_).subspan(start_);
  if (rest.size() < 2) return std::nullopt;
  uint64_t length = std::to_integer<uint8_t>(rest[1]);
  if ((length & kMasked) != 0) return fail(ErrorKind::kInvalidInput, "the server masks what it sends");
  const size_t more = length == 126 ? 2 : length == 127 ? 8 : 0;
  const size_t header = 2 + more;
  if (rest.size() < header) return std::nullopt;
  if (more > 0) length = 0;
  for (size_t i = 2; i < header; ++i) length = length << 8 | std::to_integer<uint8_t>(rest[i]);
  if (length > protocol::kMaxAnswerBytes)
    return fail(ErrorKind::kLimit, "the server sends more than a message may hold");
  if (rest.size() - header < length) return std::nullopt;
  start_ += header + length;
  return Frame{std::to_integer<uint8_t>(rest[0]), rest.subspan(header, length)};
}

Status WebSocketStream::take_piece(const Frame& frame) {
  const bool continues = (frame.first & 15) == kContinuation;
  if (continues != inside_message_) return fail(ErrorKind::kInvalidInput, "the server mixes up its messages");
  if (message_.size() + frame.content.size() > protocol::kMaxAnswerBytes) {
    return fail(ErrorKind::kLimit, "the server sends more than a message may hold");
  }
  message_.insert(message_.end(), frame.content.begin(), frame.content.end());
  whole_ = (frame.first & kLast) != 0;
  inside_message_ = !whole_;
  return {};
}

Status WebSocketStream::take(const Frame& frame) {
  switch (frame.first & ~kLast) {  // reserved bits are never agreed on
    case kContinuation:
    case kBinary:
      return take_piece(frame);
    case kPing: {
      const Bytes pong = masked_frame(kPong, frame.content, new_mask());
      replies_.insert(replies_.end(), pong.begin(), pong.end());
      return {};
    }
    case kPong:
      return {};
    case kClose:
      return fail(ErrorKind::kIo, "the server closed the connection");
    default:
      return fail(ErrorKind::kInvalidInput, "the server sends what a WebSocket must not");
  }
}

Result<std::optional<MessageStream::Bytes>> WebSocketStream::next() {
  while (!whole_) {
    const Result<std::optional<Frame>> frame = next_frame();
    if (!frame) return fail(frame.error());
    if (!*frame) return std::nullopt;
    if (Status status = take(**frame); !status) return fail(status.error());
  }
  whole_ = false;
  return std::exchange(message_, {});
}

/// The value of a header, whose name is written in lower case; empty without one.
std::string_view header_value(std::string_view answer, std::string_view name) {
  const auto same = [](char a, char b) { return std::tolower(static_cast<unsigned char>(a)) == b; };
  const std::string wanted = "\r\n" + std::string(name) + ":";
  const auto found = std::ranges::search(answer, wanted, same);
  if (found.empty()) return {};
  std::string_view value(found.end(), answer.end());
  value = value.substr(0, value.find("\r\n"));
  value.remove_prefix(std::min(value.find_first_not_of(' '), value.size()));
  return value.substr(0, value.find_last_not_of(' ') + 1);
}

}  // namespace

WebSocketHandshake WebSocketHandshake::make(const std::string& host, std::string_view key) {
  const std::string text = base64(key);
  const auto digest = sha1(text + "258EAFA5-E914-47DA-95CA-C5AB0DC85B11");  // RFC 6455, section 1.3
  return {"GET /ws HTTP/1.1\r\nHost: " + host +
              "\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Key: " +
              text + "\r\nSec-WebSocket-Protocol: surfcast.v1\r\n\r\n",
          base64({reinterpret_cast<const char*>(digest.data()), digest.size()})};
}

Status WebSocketHandshake::check(std::string_view answer) const {
  if (!answer.starts_with("HTTP/1.1 101")) {
    const std::string_view line = answer.substr(0, answer.find("\r\n"));
    return fail(ErrorKind::kUnsupported, "no WebSocket was granted: " + std::string(line.substr(0, 100)));
  }
  if (header_value(answer, "sec-websocket-accept") == expected_accept) return {};
  return fail(ErrorKind::kUnsupported, "the peer does not speak WebSocket");
}

std::unique_ptr<MessageStream> make_websocket_stream() {
  return std::make_unique<WebSocketStream>();
}

}  // namespace surfcast::client
