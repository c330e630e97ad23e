#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"

namespace surfcast::protocol {

/// Version of the framed protocol. Peers with the same major version are compatible.
struct ProtocolVersion {
  uint16_t major = 1;
  uint16_t minor = 11;
  bool operator==(const ProtocolVersion&) const = default;
};

/// The protocol version of this build.
inline constexpr ProtocolVersion kProtocolVersion{};

/// The server's reply to a client's hello. After any status but kWelcome the server closes the connection.
enum class HelloStatus : uint16_t { kWelcome = 0, kVersionRefused = 1, kBusy = 2 };

/// The first message of both sides. Its layout is the same in every version of the protocol, so that peers of different
/// versions can report why the connection is refused.
struct Hello {
  ProtocolVersion version = kProtocolVersion;
  HelloStatus status = HelloStatus::kWelcome;
  std::string program;  ///< name and version, to be displayed: "surfcastd VERSION"
  std::string message;  ///< the reason when the status is not kWelcome, one line
};

/// First bytes of a hello. The first byte is not ASCII, so a hello cannot be the start of an HTTP request.
inline constexpr std::array<uint8_t, 8> kHelloMagic{0xf5, 'S', 'U', 'R', 'F', 'C', 'S', 'T'};
/// Size of a hello without its two texts.
inline constexpr size_t kHelloHeaderBytes = 18;
inline constexpr size_t kMaxHelloTextBytes = 1024;
/// The subprotocol of WebSocket that carries the same messages.
inline constexpr std::string_view kWebSocketProtocol = "surfcast.v1";

/// The hello of this build. `program` is the name of the executable.
Hello make_hello(const std::string& program);
/// The hello of a client that will ask for `model`, if that is known: "surfcast VERSION model=church". The name is
/// escaped as in a URL. Proxies send requests for one model to one server by it; servers do not read it.
Hello make_client_hello(const std::string& program, const std::string& model);
/// Serializes a hello. Texts longer than kMaxHelloTextBytes are truncated.
std::vector<std::byte> encode_hello(const Hello& hello);

/// Number of text bytes that follow a header. Fails when the header is not that of a hello or states longer texts than
/// kMaxHelloTextBytes.
Result<size_t> hello_text_bytes(std::span<const std::byte, kHelloHeaderBytes> header);
/// Decodes a complete hello: the header and exactly the text length stated in it.
Result<Hello> decode_hello(std::span<const std::byte> bytes);

/// The server's reply to a client's hello: a welcome, or a refusal that states both versions.
Hello answer_hello(const Hello& client, const std::string& program);
/// Success when the server's reply lets the client continue. The error states both versions or the server's reason.
Status check_server_hello(const Hello& server);

}  // namespace surfcast::protocol
