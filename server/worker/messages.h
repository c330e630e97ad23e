#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "base/log_format.h"
#include "base/result.h"
#include "picture/device_info.h"
#include "picture/picture.h"
#include "render/renderer.h"

namespace surfcast::worker {

// What the server and a render worker tell each other. The server begins. Pictures nest: while the worker draws one, it
// asks now and then whether another one comes first, and waits for the answer.

/// Server: the first message.
struct Configure {
  render::RendererConfig renderer;
  LogFormat log_format = LogFormat::kText;
  bool sandbox = true;
  std::vector<std::string> readable;  ///< further files and folders that the sandbox lets the worker read
  std::vector<std::string> writable;  ///< folders that it lets the worker change
};

/// Worker: the answer to Configure. Without a device it is Refused.
struct Ready {
  picture::DeviceInfo device;
  int max_resolution = 0;
};

/// Server: a model that will be drawn. Its file descriptor travels along.
struct OfferModel {
  uint64_t model = 0;                 ///< its number
  std::string path;                   ///< for errors
  std::vector<uint32_t> quarantined;  ///< blocks that are not loaded
  std::vector<uint32_t> suspected;    ///< blocks that are loaded while no other one is
};

/// Server: a model that will not be drawn again.
struct WithdrawModel {
  uint64_t model = 0;
};

/// Server: a picture. The worker answers with Drawn or Refused, after any number of AskUrgent.
struct Draw {
  uint64_t model = 0;
  picture::PictureRequest request;
};

/// Worker, in the middle of a picture: has more urgent work to run? Draw messages may come before the answer.
struct AskUrgent {};

/// Server: the answer to AskUrgent.
struct Continue {
  bool preempted = false;  ///< there was urgent work
};

/// Worker: the picture is finished. Its pixels, if it has any, are in the shared memory.
struct Drawn {
  picture::Frame frame;
  bool pixels = false;
};

/// Worker: there is no picture, or no renderer.
struct Refused {
  Error error;
};

using Message = std::variant<Configure, Ready, OfferModel, WithdrawModel, Draw, AskUrgent, Continue, Drawn, Refused>;

[[nodiscard]] std::vector<std::byte> encode(const Message& message);
/// Fails on bytes that are no message, whatever they are.
[[nodiscard]] Result<Message> decode(std::span<const std::byte> bytes);

}  // namespace surfcast::worker
