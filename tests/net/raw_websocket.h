#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "net/raw_socket.h"
#include "protocol/hello.h"

namespace surfcast::net {

/// What a test says over a WebSocket, byte by byte, right or wrong.
class RawWebSocket {
 public:
  enum Opcode : uint8_t { kContinuation = 0, kText = 1, kBinary = 2, kClose = 8, kPing = 9, kPong = 10 };
  struct Frame {
    uint8_t opcode = 0xff;  ///< 0xff: the connection has ended
    bool last = true;
    std::string content;
  };

  explicit RawWebSocket(uint16_t port, const std::string& more_headers = "", int receive_buffer = 0)
      : socket(port, receive_buffer) {
    socket.send(
        "GET /ws HTTP/1.1\r\nHost: here\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
        "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Protocol: other, surfcast.v1\r\n" +
        more_headers + "\r\n");
    answer = socket.read_http();
  }

  static std::string frame(uint8_t first_byte, std::string_view content, bool masked = true) {
    std::string bytes{static_cast<char>(first_byte)};
    const uint8_t mask_bit = masked ? 0x80 : 0;
    if (content.size() < 126) {
      bytes += static_cast<char>(mask_bit | content.size());
    } else {
      const bool small = content.size() < 65536;
      bytes += static_cast<char>(mask_bit | (small ? 126 : 127));
      for (int shift = small ? 8 : 56; shift >= 0; shift -= 8)
        bytes += static_cast<char>(uint64_t{content.size()} >> shift & 0xff);
    }
    if (masked) bytes += "\x01\x02\x03\x04";
    for (size_t i = 0; i < content.size(); ++i) bytes += static_cast<char>(content[i] ^ (masked ? i % 4 + 1 : 0));
    return bytes;
  }
  bool send(Opcode opcode, std::string_view content, bool last = true) {
    return socket.send(frame(static_cast<uint8_t>(opcode | (last ? 0x80 : 0)), content));
  }
  bool send_hello(protocol::Hello hello = protocol::make_hello("test")) {
    const auto bytes = protocol::encode_hello(hello);
    return send(kBinary, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  }

  Frame read_frame() {
    const std::string head = socket.read_exactly(2);
    if (head.size() < 2) return {};
    uint64_t length = static_cast<uint8_t>(head[1]);
    const size_t more = length == 126 ? 2 : length == 127 ? 8 : 0;
    if (more > 0) length = 0;
    for (const char c : socket.read_exactly(more)) length = length << 8 | static_cast<uint8_t>(c);
    return {static_cast<uint8_t>(head[0] & 15), (head[0] & 0x80) != 0, socket.read_exactly(length)};
  }
  /// A whole message; pings are left out.
  std::string read_message() {
    std::string content;
    for (;;) {
      const Frame next = read_frame();
      if (next.opcode == kPing) continue;
      content += next.content;
      if (next.last) return content;
    }
  }
  /// The status of the close frame that comes next; 0 when something else does.
  unsigned read_close() {
    const Frame next = read_frame();
    if (next.opcode != kClose || next.content.size() < 2) return 0;
    return static_cast<unsigned>(static_cast<uint8_t>(next.content[0]) << 8 | static_cast<uint8_t>(next.content[1]));
  }

  RawSocket socket;
  std::string answer;  ///< of HTTP to the request
};

}  // namespace surfcast::net
