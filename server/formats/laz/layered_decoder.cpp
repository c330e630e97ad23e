#include <cstring>
#include <optional>
#include <utility>
#include <vector>

#include "laz/channel_states.h"
#include "laz/color_decoder.h"
#include "laz/layer.h"
#include "laz/point14_decoder.h"
#include "laz/record_decoder.h"
#include "laz/wave_packet_decoder.h"

namespace surfcast::laz {
namespace {

struct ColorWithInfrared {
  Color color{};
  uint16_t infrared = 0;
};

/// The state of items RGB14 and RGBNIR14 in one scanner channel.
struct ColorChannel {
  explicit ColorChannel(const ColorWithInfrared& first) : last(first) {}

  ColorWithInfrared last;
  ColorDecoder color;
  SymbolModel<4> infrared_changes;
  std::array<SymbolModel<256>, 2> infrared_steps;

  uint16_t decode_infrared(ArithmeticDecoder& in, uint16_t before) {
    const uint32_t changes = in.symbol(infrared_changes);
    uint32_t low = before & 255U;
    uint32_t high = before >> 8U;
    if (changes & 1) low += in.symbol(infrared_steps[0]);
    if (changes & 2) high += in.symbol(infrared_steps[1]);
    return static_cast<uint16_t>((low & 255) | (high & 255) << 8);
  }
};

/// The state of item WAVEPACKET14 in one scanner channel.
struct WavePacketChannel {
  explicit WavePacketChannel(const WavePacket& first) : last(first) {}

  WavePacket last;
  WavePacketDecoder packet;
};

/// The state of item BYTE14 in one scanner channel.
struct ExtraBytesChannel {
  explicit ExtraBytesChannel(const std::vector<std::byte>& first) : last(first), models(first.size()) {}

  std::vector<std::byte> last;
  std::vector<std::unique_ptr<SymbolModel<256>>> models;  ///< of the bytes that change
};

/// The layers of a chunk: all sizes first, then all bytes, in the same order.
class LayerBytes {
 public:
  LayerBytes(std::span<const std::byte> sizes, std::span<const std::byte> bytes) : sizes_(sizes), bytes_(bytes) {}

  Layer next() {
    const size_t size = load<uint32_t>(sizes_.data());
    sizes_ = sizes_.subspan(sizeof(uint32_t));
    enough_ = enough_ && size <= bytes_.size();
    const size_t there = std::min(size, bytes_.size());
    const std::span<const std::byte> layer = bytes_.first(there);
    bytes_ = bytes_.subspan(there);
    return Layer(layer);
  }
  [[nodiscard]] bool enough() const { return enough_; }

 private:
  std::span<const std::byte> sizes_, bytes_;
  bool enough_ = true;
};

struct Layers {
  Point14Layers point;
  Layer color;
  Layer infrared;
  Layer wave_packet;
  std::vector<Layer> extra_bytes;
};

size_t layer_count(const RecordLayout& layout) {
  return 9 + (layout.color ? 1 : 0) + (layout.infrared ? 1 : 0) + (layout.wave_packet ? 1 : 0) + layout.extra_bytes();
}

Layers take_layers(const RecordLayout& layout, LayerBytes& bytes) {
  Layers layers;
  Point14Layers& point = layers.point;
  for (Layer* layer : {&point.returns_xy, &point.z, &point.classification, &point.flags, &point.intensity, &point.angle,
                       &point.user, &point.source, &point.time}) {
    *layer = bytes.next();
  }
  if (layout.color) layers.color = bytes.next();
  if (layout.infrared) layers.infrared = bytes.next();
  if (layout.wave_packet) layers.wave_packet = bytes.next();
  for (size_t i = 0; i < layout.extra_bytes(); ++i) layers.extra_bytes.push_back(bytes.next());
  return layers;
}

bool damaged(const Layers& layers) {
  const Point14Layers& point = layers.point;
  for (const Layer* layer :
       {&point.returns_xy, &point.z, &point.classification, &point.flags, &point.intensity, &point.angle, &point.user,
        &point.source, &point.time, &layers.color, &layers.infrared, &layers.wave_packet}) {
    if (layer->damaged()) return true;
  }
  return std::any_of(layers.extra_bytes.begin(), layers.extra_bytes.end(),
                     [](const Layer& layer) { return layer.damaged(); });
}

ColorWithInfrared first_color(const RecordLayout& layout, const std::byte* record) {
  ColorWithInfrared color;
  if (layout.color) color.color = load_color(record + layout.color_offset);
  if (layout.infrared) color.infrared = load<uint16_t>(record + layout.color_offset + sizeof(Color));
  return color;
}

WavePacket first_packet(const RecordLayout& layout, const std::byte* record) {
  return layout.wave_packet ? WavePacket::from_record(record + layout.wave_offset) : WavePacket();
}

class LayeredDecoder final : public RecordDecoder {
 public:
  /// `first` is the first record, which is stored uncompressed.
  LayeredDecoder(const RecordLayout& layout, bool stale_channels, const std::byte* first, Layers layers)
      : layout_(layout),
        stale_channels_(stale_channels),
        first_(first, first + layout.length),
        layers_(std::move(layers)),
        points_(channel_of(first), Point14::from_record(first)),
        colors_(channel_of(first), first_color(layout, first)),
        wave_packets_(channel_of(first), first_packet(layout, first)),
        extra_bytes_(channel_of(first), std::vector(first + layout.extra_offset, first + layout.length)) {}

  void decode(std::span<std::byte> records) override {
    if (!first_.empty() && !records.empty()) {
      std::memcpy(records.data(), first_.data(), layout_.length);
      records = records.subspan(layout_.length);
      first_.clear();
    }
    for (; !records.empty(); records = records.subspan(layout_.length)) decode_record(records.data());
  }

  [[nodiscard]] bool damaged() const override { return laz::damaged(layers_); }

 private:
  void decode_record(std::byte* record) {
    decode_point(record);
    if (layout_.color) decode_color(record + layout_.color_offset);
    if (layout_.wave_packet) decode_wave_packet(record + layout_.wave_offset);
    if (layout_.extra_bytes() != 0) decode_extra_bytes(record + layout_.extra_offset);
  }

  void decode_point(std::byte* record) {
    constexpr uint32_t kChannelChanged = 64;
    ArithmeticDecoder& in = layers_.point.returns_xy.in;
    const uint32_t changes = points_.current().decode_changes(in);
    const bool channel_changed = changes & kChannelChanged;
    if (channel_changed) points_.change((points_.channel() + points_.current().decode_channel_step(in)) % 4);
    item_channel_ = stale_channels_ && !channel_changed ? 0 : points_.channel();
    Point14Channel& channel = points_.current();
    channel.decode(layers_.point, changes);
    channel.last.write(record, points_.channel());
  }

  /// Switches an item to its channel. Returns the state that holds the last value.
  template <typename State>
  State& follow_channel(ChannelStates<State>& states) {
    if (states.channel() == item_channel_) return states.current();
    State& before = states.change(item_channel_);
    return stale_channels_ ? before : states.current();
  }

  void decode_color(std::byte* color) {
    ColorWithInfrared& last = follow_channel(colors_).last;
    ColorChannel& models = colors_.current();
    if (layers_.color.present) last.color = models.color.decode(layers_.color.in, last.color);
    std::memcpy(color, last.color.data(), sizeof(Color));
    if (!layout_.infrared) return;
    if (layers_.infrared.present) last.infrared = models.decode_infrared(layers_.infrared.in, last.infrared);
    store(color + sizeof(Color), last.infrared);
  }

  void decode_wave_packet(std::byte* packet) {
    WavePacket& last = follow_channel(wave_packets_).last;
    WavePacketDecoder& models = wave_packets_.current().packet;
    if (layers_.wave_packet.present) last = models.decode(layers_.wave_packet.in, last);
    last.write(packet);
  }

  void decode_extra_bytes(std::byte* bytes) {
    std::vector<std::byte>& last = follow_channel(extra_bytes_).last;
    ExtraBytesChannel& channel = extra_bytes_.current();
    for (size_t i = 0; i < last.size(); ++i) {
      if (layers_.extra_bytes[i].present) last[i] = next_byte(layers_.extra_bytes[i].in, channel.models[i], last[i]);
      bytes[i] = last[i];
    }
  }

  static std::byte next_byte(ArithmeticDecoder& in, std::unique_ptr<SymbolModel<256>>& model, std::byte last) {
    if (!model) model = std::make_unique<SymbolModel<256>>();
    return static_cast<std::byte>(std::to_integer<uint32_t>(last) + in.symbol(*model));
  }

  RecordLayout layout_;
  bool stale_channels_;
  std::vector<std::byte> first_;  ///< empty once it has been returned
  Layers layers_;
  ChannelStates<Point14Channel> points_;
  uint32_t item_channel_ = 0;  ///< the channel whose states decode the items after the point
  ChannelStates<ColorChannel> colors_;
  ChannelStates<WavePacketChannel> wave_packets_;
  ChannelStates<ExtraBytesChannel> extra_bytes_;
};

}  // namespace

Result<std::unique_ptr<RecordDecoder>> decode_layered(const RecordLayout& layout, std::span<const std::byte> chunk,
                                                      size_t count, bool stale_channels) {
  const size_t count_bytes = sizeof(uint32_t);
  const size_t size_bytes = layer_count(layout) * sizeof(uint32_t);
  if (chunk.size() < layout.length + count_bytes + size_bytes) {
    return fail(ErrorKind::kInvalidInput, "truncated: a LAZ chunk is too short");
  }
  if (load<uint32_t>(&chunk[layout.length]) < count) {
    return fail(ErrorKind::kInvalidInput, "a LAZ chunk has fewer points than the chunk table states");
  }
  const std::span<const std::byte> sizes = chunk.subspan(layout.length + count_bytes, size_bytes);
  LayerBytes bytes(sizes, chunk.subspan(layout.length + count_bytes + size_bytes));
  Layers layers = take_layers(layout, bytes);
  if (!bytes.enough()) return fail(ErrorKind::kInvalidInput, "a LAZ chunk is shorter than its layers");
  // Every point but the first takes a part of this layer. Without it any number of points would decode from nothing.
  if (count > 1 && !layers.point.returns_xy.present) {
    return fail(ErrorKind::kInvalidInput, "a LAZ chunk is damaged: its points have no positions");
  }
  return std::make_unique<LayeredDecoder>(layout, stale_channels, chunk.data(), std::move(layers));
}

}  // namespace surfcast::laz
