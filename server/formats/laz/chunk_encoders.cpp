#include "laz/chunk_encoders.h"

#include <optional>

#include "laz/integer_encoder.h"
#include "laz/item_encoders.h"
#include "laz/laszip_record.h"
#include "laz/point14_encoder.h"

namespace surfcast::laz {
namespace {

using Bytes = std::vector<std::byte>;

void append(Bytes& to, std::span<const std::byte> from) {
  to.insert(to.end(), from.begin(), from.end());
}

template <typename T>
void append_number(Bytes& to, T number) {
  to.resize(to.size() + sizeof(T));
  store(&to[to.size() - sizeof(T)], number);
}

uint32_t step(std::byte from, std::byte to) {
  return (std::to_integer<uint32_t>(to) - std::to_integer<uint32_t>(from)) & 255;
}

/// Items behind the point in one scanner channel.
struct ColorChannelEncoder {
  explicit ColorChannelEncoder(const Bytes& first) : last(first) {}

  void encode_infrared(ArithmeticEncoder& out, const std::byte* from, const std::byte* to) {
    out.symbol(infrared_changes, (to[6] != from[6] ? 1U : 0U) + (to[7] != from[7] ? 2U : 0U));
    if (to[6] != from[6]) out.symbol(infrared_steps[0], step(from[6], to[6]));
    if (to[7] != from[7]) out.symbol(infrared_steps[1], step(from[7], to[7]));
  }

  Bytes last;
  ColorEncoder color;
  SymbolModel<4> infrared_changes;
  std::array<SymbolModel<256>, 2> infrared_steps;
};

struct WavePacketChannelEncoder {
  explicit WavePacketChannelEncoder(const WavePacket& first) : last(first) {}
  WavePacket last;
  WavePacketEncoder packet;
};

struct ExtraChannelEncoder {
  explicit ExtraChannelEncoder(const Bytes& first) : last(first), models(first.size()) {}
  Bytes last;
  std::vector<SymbolModel<256>> models;
};

class LayeredEncoder {
 public:
  LayeredEncoder(const RecordLayout& layout, bool stale, const std::byte* first)
      : layout_(layout),
        stale_(stale),
        points_(channel_of(first), Point14::from_record(first)),
        colors_(channel_of(first), Bytes(first + 30, first + layout.wave_offset)),
        wave_packets_(channel_of(first), packet_of(first)),
        extra_(channel_of(first), Bytes(first + layout.extra_offset, first + layout.length)),
        extra_layers_(layout.extra_bytes()) {}

  void encode(const std::byte* record) {
    const Point14 point = Point14::from_record(record);
    const uint32_t before = points_.channel(), now = channel_of(record);
    Point14ChannelEncoder& old = points_.current();
    points_.change(now);
    const uint32_t changes = points_.current().changes_to(point);
    old.encode_changes(layers_.returns_xy.out, changes | (now != before ? 64U : 0U), (now - before) & 3);
    points_.current().encode(layers_, point, changes);
    item_channel_ = stale_ && now == before ? 0 : now;
    if (layout_.color) encode_color(record + 30);
    if (layout_.wave_packet) encode_wave_packet(record);
    encode_extra(record + layout_.extra_offset);
  }

  Bytes finish() {
    std::vector<LayerOut*> all = {&layers_.returns_xy, &layers_.z,         &layers_.classification,
                                  &layers_.flags,      &layers_.intensity, &layers_.angle,
                                  &layers_.user,       &layers_.source,    &layers_.time};
    if (layout_.color) all.push_back(&color_layer_);
    if (layout_.infrared) all.push_back(&infrared_layer_);
    if (layout_.wave_packet) all.push_back(&wave_packet_layer_);
    for (LayerOut& layer : extra_layers_) all.push_back(&layer);
    Bytes sizes, bytes;
    for (LayerOut* layer : all) {
      const Bytes content = layer->changed ? layer->out.finish() : Bytes();
      append_number(sizes, static_cast<uint32_t>(content.size()));
      append(bytes, content);
    }
    append(sizes, bytes);
    return sizes;
  }

 private:
  [[nodiscard]] WavePacket packet_of(const std::byte* record) const {
    return layout_.wave_packet ? WavePacket::from_record(record + layout_.wave_offset) : WavePacket();
  }

  template <typename State>
  auto& follow(ChannelStates<State>& states) {
    if (states.channel() == item_channel_) return states.current().last;
    auto& before = states.change(item_channel_).last;
    return stale_ ? before : states.current().last;
  }

  void encode_color(const std::byte* color) {
    Bytes& last = follow(colors_);
    ColorChannelEncoder& channel = colors_.current();
    color_layer_.changed |= !std::equal(color, color + 6, last.begin());
    channel.color.encode(color_layer_.out, load_color(last.data()), load_color(color));
    if (layout_.infrared) {
      infrared_layer_.changed |= color[6] != last[6] || color[7] != last[7];
      channel.encode_infrared(infrared_layer_.out, last.data(), color);
    }
    std::copy_n(color, last.size(), last.begin());
  }

  void encode_wave_packet(const std::byte* record) {
    WavePacket& last = follow(wave_packets_);
    const WavePacket packet = packet_of(record);
    wave_packet_layer_.changed |= !(packet == last);
    wave_packets_.current().packet.encode(wave_packet_layer_.out, last, packet);
    last = packet;
  }

  void encode_extra(const std::byte* bytes) {
    Bytes& last = follow(extra_);
    for (size_t i = 0; i < last.size(); ++i) {
      extra_layers_[i].changed |= bytes[i] != last[i];
      extra_layers_[i].out.symbol(extra_.current().models[i], step(last[i], bytes[i]));
      last[i] = bytes[i];
    }
  }

  RecordLayout layout_;
  bool stale_;
  uint32_t item_channel_ = 0;
  ChannelStates<Point14ChannelEncoder> points_;
  ChannelStates<ColorChannelEncoder> colors_;
  ChannelStates<WavePacketChannelEncoder> wave_packets_;
  ChannelStates<ExtraChannelEncoder> extra_;
  Point14LayersOut layers_;
  LayerOut color_layer_, infrared_layer_, wave_packet_layer_;
  std::vector<LayerOut> extra_layers_;
};

Bytes encode_pointwise(const RecordLayout& layout, std::span<const std::byte> records) {
  const std::byte* last = records.data();
  ArithmeticEncoder out;
  Point10Encoder point(last);
  GpsTimeEncoder<true> time(layout.gps_time ? load<int64_t>(last + 20) : 0);
  ColorEncoder color;
  WavePacketEncoder wave_packets;
  std::vector<SymbolModel<256>> extra(layout.extra_bytes());
  for (const std::byte* now = last + layout.length; now != records.data() + records.size(); now += layout.length) {
    point.encode(out, now);
    if (layout.gps_time) time.encode(out, load<int64_t>(now + 20));
    if (layout.color) color.encode(out, load_color(last + layout.color_offset), load_color(now + layout.color_offset));
    if (layout.wave_packet) {
      wave_packets.encode(out, WavePacket::from_record(last + layout.wave_offset),
                          WavePacket::from_record(now + layout.wave_offset));
    }
    for (size_t i = layout.extra_offset; i < layout.length; ++i) {
      out.symbol(extra[i - layout.extra_offset], step(last[i], now[i]));
    }
    last = now;
  }
  Bytes chunk(records.begin(), records.begin() + static_cast<ptrdiff_t>(layout.length));
  append(chunk, out.finish());
  return chunk;
}

Bytes encode_layered(const RecordLayout& layout, std::span<const std::byte> records, bool stale) {
  LayeredEncoder encoder(layout, stale, records.data());
  for (size_t at = layout.length; at < records.size(); at += layout.length) encoder.encode(&records[at]);
  Bytes chunk(records.begin(), records.begin() + static_cast<ptrdiff_t>(layout.length));
  append_number(chunk, static_cast<uint32_t>(records.size() / layout.length));
  append(chunk, encoder.finish());
  return chunk;
}

}  // namespace

Bytes encode_chunk(const Coding& coding, std::span<const std::byte> records) {
  // Up to version 3 the items behind the point keep to the first channel until the channel changes.
  if (coding.layout.layered) return encode_layered(coding.layout, records, coding.layered_version < 4);
  return encode_pointwise(coding.layout, records);
}

Bytes encode_chunk_table(const Coding& coding, std::span<const ChunkSize> chunks) {
  ArithmeticEncoder out;
  IntegerEncoder<32, 2> numbers;
  ChunkSize last;
  for (const ChunkSize& chunk : chunks) {
    if (coding.chunk_size == kVariableChunks)
      numbers.encode(out, static_cast<int32_t>(last.points), static_cast<int32_t>(chunk.points), 0);
    numbers.encode(out, static_cast<int32_t>(last.bytes), static_cast<int32_t>(chunk.bytes), 1);
    last = chunk;
  }
  Bytes table;
  append_number(table, uint32_t{0});  // version
  append_number(table, static_cast<uint32_t>(chunks.size()));
  append(table, out.finish());
  return table;
}

Bytes encode_laszip_record(const Coding& coding) {
  const RecordLayout& layout = coding.layout;
  const uint16_t newer = coding.layered_version;
  Bytes items;
  uint16_t count = 0;
  const auto item = [&](uint16_t type, size_t size, uint16_t version) {
    append_number(items, type);
    append_number(items, static_cast<uint16_t>(size));
    append_number(items, version);
    ++count;
  };
  layout.layered ? item(10, 30, newer) : item(6, 20, 2);
  if (layout.gps_time) item(7, 8, 2);
  if (layout.color && !layout.layered) item(8, 6, 2);
  if (layout.color && layout.layered) layout.infrared ? item(12, 8, newer) : item(11, 6, newer);
  if (layout.wave_packet) layout.layered ? item(13, 29, newer) : item(9, 29, 1);
  if (layout.extra_bytes() != 0)
    layout.layered ? item(14, layout.extra_bytes(), newer) : item(0, layout.extra_bytes(), 2);
  Bytes record;
  append_number(record, static_cast<uint16_t>(layout.layered ? 3 : 2));  // compressor
  append_number(record, uint16_t{0});                                    // arithmetic coder
  append_number(record, uint8_t{3});                                     // version 3.4, revision 3, of LASzip
  append_number(record, uint8_t{4});
  append_number(record, uint16_t{3});
  append_number(record, uint32_t{0});  // options
  append_number(record, coding.chunk_size);
  append_number(record, int64_t{-1});  // extended records: none are special
  append_number(record, int64_t{-1});
  append_number(record, count);
  append(record, items);
  return record;
}

}  // namespace surfcast::laz
