#include "protocol/hello.h"

#include <algorithm>
#include <cstring>

#include "protocol/errors.h"
#include "protocol/little_endian.h"
#include "protocol/url_query.h"

namespace surfcast::protocol {
namespace {

// Offsets of the header's fields.
constexpr size_t kMajor = 8;
constexpr size_t kMinor = 10;
constexpr size_t kStatus = 12;
constexpr size_t kProgramBytes = 14;
constexpr size_t kMessageBytes = 16;

/// Text from a peer is shown on terminals and in logs, so it becomes one line without control characters.
std::string text_of(std::span<const std::byte> bytes) {
  return clean_utf8({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

std::string to_string(ProtocolVersion version) {
  return std::to_string(version.major) + "." + std::to_string(version.minor);
}

void append_text(std::vector<std::byte>& bytes, const std::string& text) {
  const auto* first = reinterpret_cast<const std::byte*>(text.data());
  bytes.insert(bytes.end(), first, first + std::min(text.size(), kMaxHelloTextBytes));
}

}  // namespace

Hello make_hello(const std::string& program) {
  Hello hello;
  hello.program = program + " " + SURFCAST_VERSION;
  return hello;
}

Hello make_client_hello(const std::string& program, const std::string& model) {
  Hello hello = make_hello(program);
  if (!model.empty()) hello.program += " model=" + encode_escapes(model);
  return hello;
}

std::vector<std::byte> encode_hello(const Hello& hello) {
  std::vector<std::byte> bytes(kHelloHeaderBytes);
  std::memcpy(bytes.data(), kHelloMagic.data(), kHelloMagic.size());
  store_u16(&bytes[kMajor], hello.version.major);
  store_u16(&bytes[kMinor], hello.version.minor);
  store_u16(&bytes[kStatus], static_cast<uint16_t>(hello.status));
  store_u16(&bytes[kProgramBytes], static_cast<uint16_t>(std::min(hello.program.size(), kMaxHelloTextBytes)));
  store_u16(&bytes[kMessageBytes], static_cast<uint16_t>(std::min(hello.message.size(), kMaxHelloTextBytes)));
  append_text(bytes, hello.program);
  append_text(bytes, hello.message);
  return bytes;
}

Result<size_t> hello_text_bytes(std::span<const std::byte, kHelloHeaderBytes> header) {
  if (std::memcmp(header.data(), kHelloMagic.data(), kHelloMagic.size()) != 0) {
    return fail(ErrorKind::kUnsupported, "the peer does not speak the surfcast protocol");
  }
  const size_t program = load_u16(&header[kProgramBytes]);
  const size_t message = load_u16(&header[kMessageBytes]);
  if (program > kMaxHelloTextBytes || message > kMaxHelloTextBytes) {
    return fail(ErrorKind::kInvalidInput, "the peer's hello is longer than " + std::to_string(kMaxHelloTextBytes));
  }
  return program + message;
}

Result<Hello> decode_hello(std::span<const std::byte> bytes) {
  if (bytes.size() < kHelloHeaderBytes) return fail(ErrorKind::kInvalidInput, "the peer's hello is cut short");
  const Result<size_t> text = hello_text_bytes(bytes.first<kHelloHeaderBytes>());
  if (!text) return fail(text);
  if (bytes.size() != kHelloHeaderBytes + *text) {
    return fail(ErrorKind::kInvalidInput, "the peer's hello does not have the length it announces");
  }
  const size_t program = load_u16(&bytes[kProgramBytes]);
  Hello hello;
  hello.version = {load_u16(&bytes[kMajor]), load_u16(&bytes[kMinor])};
  hello.status = static_cast<HelloStatus>(load_u16(&bytes[kStatus]));
  hello.program = text_of(bytes.subspan(kHelloHeaderBytes, program));
  hello.message = text_of(bytes.subspan(kHelloHeaderBytes + program));
  return hello;
}

Hello answer_hello(const Hello& client, const std::string& program) {
  Hello answer = make_hello(program);
  if (client.version.major == kProtocolVersion.major) return answer;
  answer.status = HelloStatus::kVersionRefused;
  answer.message = answer.program + " speaks protocol " + to_string(kProtocolVersion) + ", and " + client.program +
                   " speaks protocol " + to_string(client.version) + ": use programs of one version";
  return answer;
}

Status check_server_hello(const Hello& server) {
  if (server.status == HelloStatus::kBusy) {
    return fail(ErrorKind::kUnavailable, server.message.empty() ? "the server is busy" : server.message);
  }
  if (server.version.major != kProtocolVersion.major) {
    return fail(ErrorKind::kUnsupported, "the server (" + server.program + ") speaks protocol " +
                                             to_string(server.version) + ", this program speaks " +
                                             to_string(kProtocolVersion) + ": use programs of one version");
  }
  if (server.status == HelloStatus::kWelcome) return {};
  return fail(ErrorKind::kUnsupported, "the server refuses: " + server.message);
}

}  // namespace surfcast::protocol
