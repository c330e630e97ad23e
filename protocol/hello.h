#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/result.h"

namespace surfcast::protocol {

/// Version of the framed protocol. Peers of one major version understand each other.
struct ProtocolVersion {
  uint16_t major = 1;
  uint16_t minor = 1;
  bool operator==(const ProtocolVersion&) const = default;
};

/// The version this program speaks.
inline constexpr ProtocolVersion kProtocolVersion{};

/// What a server says to a client's hello; anything but kWelcome is followed by the end of the connection.
enum class HelloStatus : uint16_t { kWelcome = 0, kVersionRefused = 1, kBusy = 2 };

/// The first words of both sides. Its layout is the same in every version of the protocol, so that peers of any age
/// can tell each other why they part.
struct Hello {
  ProtocolVersion version = kProtocolVersion;
  HelloStatus status = HelloStatus::kWelcome;
  std::string program;  ///< name and version, for a person: "surfcastd 0.1.0"
  std::string message;  ///< why the status is not kWelcome, one line
};

/// First bytes of a hello. No HTTP method begins with a byte beyond ASCII.
inline constexpr std::array<uint8_t, 8> kHelloMagic{0xf5, 'S', 'U', 'R', 'F', 'C', 'S', 'T'};
/// Bytes of a hello before its two texts.
inline constexpr size_t kHelloHeaderBytes = 18;
inline constexpr size_t kMaxHelloTextBytes = 1024;

/// A hello of this build: `program` is the name of the executable.
Hello make_hello(const std::string& program);
/// Texts longer than kMaxHelloTextBytes are cut.
std::vector<std::byte> encode_hello(const Hello& hello);

/// How many bytes of text follow this header. Fails when the peer does not speak this protocol at all.
Result<size_t> hello_text_bytes(std::span<const std::byte, kHelloHeaderBytes> header);
/// Decodes a whole hello: the header and exactly the text that it announces.
Result<Hello> decode_hello(std::span<const std::byte> bytes);

/// What a server answers to a client of that version: a welcome, or a refusal that names both versions.
Hello answer_hello(const Hello& client, const std::string& program);
/// Whether a client can go on after this answer; the error names both versions or repeats the server's reason.
Status check_server_hello(const Hello& server);

}  // namespace surfcast::protocol
