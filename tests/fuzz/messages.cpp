#include "fuzz/targets.h"
#include "net/http_route.h"
#include "protocol/framing.h"
#include "protocol/hello.h"
#include "protocol/picture_query.h"
#include "protocol/points_query.h"
#include "protocol/profile_query.h"
#include "protocol/validate.h"
#include "warp/depth_plane.h"

namespace surfcast::fuzz {
namespace {

constexpr size_t kLargestFrame = size_t{1} << 20;

std::string_view text_of(Bytes bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

}  // namespace

void read_hello(Bytes bytes) {
  if (bytes.size() < protocol::kHelloHeaderBytes) return;
  const auto text = protocol::hello_text_bytes(bytes.first<protocol::kHelloHeaderBytes>());
  if (!text || bytes.size() < protocol::kHelloHeaderBytes + *text) return;
  const Result<protocol::Hello> decoded = protocol::decode_hello(bytes.first(protocol::kHelloHeaderBytes + *text));
  if (!decoded) return;
  static_cast<void>(protocol::check_server_hello(*decoded));
  static_cast<void>(protocol::encode_hello(protocol::answer_hello(*decoded, "surfcastd")));
}

void read_frames(Bytes bytes) {
  while (bytes.size() >= protocol::kFrameHeaderBytes) {
    const Result<size_t> length = protocol::frame_length(bytes.first<protocol::kFrameHeaderBytes>(), kLargestFrame);
    bytes = bytes.subspan(protocol::kFrameHeaderBytes);
    if (!length || *length > bytes.size()) return;
    read_request(bytes.first(*length));
    bytes = bytes.subspan(*length);
  }
}

void read_request(Bytes bytes) {
  wire::Request message;
  if (!protocol::decode_message(bytes, message)) return;
  if (message.has_draw_picture()) static_cast<void>(protocol::check_picture(message.draw_picture()));
  if (message.has_open_view()) static_cast<void>(protocol::check_view(message.open_view()));
  if (message.has_get_profile()) static_cast<void>(protocol::check_profile(message.get_profile()));
  if (message.has_get_points()) static_cast<void>(protocol::check_points(message.get_points()));
  static_cast<void>(protocol::encode_message(message, kLargestFrame));
}

void read_answer(Bytes bytes) {
  wire::Answer message;
  if (!protocol::decode_message(bytes, message)) return;
  if (message.has_profile()) static_cast<void>(protocol::check_profile_answer(message.profile()));
}

void read_depth(Bytes bytes) {
  wire::DepthPlane plane;
  if (!protocol::decode_message(bytes, plane)) return;
  static_cast<void>(warp::decode_depth(plane, 64, 48));
}

void read_route(Bytes bytes) {
  static_cast<void>(net::parse_target(text_of(bytes)));
}

void read_query(Bytes bytes) {
  if (auto picture = protocol::parse_picture_query("model", text_of(bytes))) {
    static_cast<void>(protocol::check_picture(*picture));
  }
  static_cast<void>(protocol::parse_pick_query("model", text_of(bytes)));
  static_cast<void>(protocol::parse_profile_query("model", text_of(bytes)));
  static_cast<void>(protocol::parse_points_query("model", text_of(bytes)));
}

}  // namespace surfcast::fuzz
