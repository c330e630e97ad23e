#include <algorithm>

#include "client/message_stream.h"
#include "protocol/framing.h"

namespace surfcast::client {
namespace {

class FramedStream : public MessageStream {
 public:
  Bytes encode(std::span<const std::byte> message) override {
    const auto header = protocol::frame_header(message.size());
    Bytes bytes(header.size() + message.size());
    std::ranges::copy(message, std::ranges::copy(header, bytes.begin()).out);
    return bytes;
  }
  void append(std::span<const std::byte> bytes) override { splitter_.append(bytes); }
  Result<std::optional<Bytes>> next() override { return splitter_.next(); }
  Bytes take_replies() override { return {}; }

 private:
  protocol::FrameSplitter splitter_{protocol::kMaxAnswerBytes};
};

}  // namespace

std::unique_ptr<MessageStream> make_framed_stream() {
  return std::make_unique<FramedStream>();
}

}  // namespace surfcast::client
