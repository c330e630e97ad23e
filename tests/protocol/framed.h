#pragma once

#include <cstddef>
#include <vector>

#include "protocol/framing.h"

namespace surfcast::protocol {

/// A message within the limits with its length before it.
template <typename Message>
std::vector<std::byte> framed(const Message& message) {
  std::vector<std::byte> frame = encode_message(message, kMaxAnswerBytes).value();
  const auto header = frame_header(frame.size());
  frame.insert(frame.begin(), header.begin(), header.end());
  return frame;
}

}  // namespace surfcast::protocol
