#include <cstring>
#include <optional>
#include <vector>

#include "laz/color_decoder.h"
#include "laz/gps_time_decoder.h"
#include "laz/point10_decoder.h"
#include "laz/record_decoder.h"
#include "laz/wave_packet_decoder.h"

namespace surfcast::laz {
namespace {

/// Decodes extra bytes: each one is coded as the difference to the same byte of the last record.
class ExtraBytesDecoder {
 public:
  ExtraBytesDecoder(const std::byte* first, size_t count) : last_(first, first + count), models_(count) {}

  void decode(ArithmeticDecoder& in, std::byte* bytes) {
    for (size_t i = 0; i < last_.size(); ++i) {
      const uint32_t step = in.symbol(models_[i]);
      last_[i] = static_cast<std::byte>(std::to_integer<uint32_t>(last_[i]) + step);
      bytes[i] = last_[i];
    }
  }

 private:
  std::vector<std::byte> last_;
  std::vector<SymbolModel<256>> models_;
};

/// Decodes all items of a record sequentially, from one stream. The first record is stored uncompressed.
class PointwiseDecoder final : public RecordDecoder {
 public:
  PointwiseDecoder(const RecordLayout& layout, std::span<const std::byte> chunk)
      : layout_(layout),
        first_(chunk.begin(), chunk.begin() + static_cast<ptrdiff_t>(layout.length)),
        in_(chunk.subspan(layout.length)),
        point_(chunk.data()),
        extra_bytes_(chunk.data() + layout.extra_offset, layout.extra_bytes()) {
    if (layout.gps_time) gps_time_.emplace(load<int64_t>(chunk.data() + Point10Decoder::kBytes));
    if (layout.color) last_color_ = load_color(chunk.data() + layout.color_offset);
    if (layout.wave_packet) start_wave_packets(chunk.data() + layout.wave_offset);
  }

  void decode(std::span<std::byte> records) override {
    if (!first_.empty() && !records.empty()) {
      std::memcpy(records.data(), first_.data(), layout_.length);
      records = records.subspan(layout_.length);
      first_.clear();
    }
    ArithmeticDecoder in = in_;
    for (; !records.empty(); records = records.subspan(layout_.length)) decode_record(in, records.data());
    in_ = in;
  }

  [[nodiscard]] bool damaged() const override { return in_.damaged(); }

 private:
  void decode_record(ArithmeticDecoder& in, std::byte* record) {
    point_.decode(in, record);
    if (gps_time_) {
      gps_time_->decode(in);
      store(record + Point10Decoder::kBytes, gps_time_->time());
    }
    if (layout_.color) {
      last_color_ = color_.decode(in, last_color_);
      std::memcpy(record + layout_.color_offset, last_color_.data(), sizeof(Color));
    }
    if (wave_packets_) {
      last_packet_ = wave_packets_->decode(in, last_packet_);
      last_packet_.write(record + layout_.wave_offset);
    }
    extra_bytes_.decode(in, record + layout_.extra_offset);
  }

  void start_wave_packets(const std::byte* first) {
    wave_packets_.emplace();
    last_packet_ = WavePacket::from_record(first);
  }

  RecordLayout layout_;
  std::vector<std::byte> first_;  ///< empty once it has been returned
  ArithmeticDecoder in_;
  Point10Decoder point_;
  std::optional<GpsTimeDecoder<true>> gps_time_;
  ColorDecoder color_;
  Color last_color_{};
  std::optional<WavePacketDecoder> wave_packets_;
  WavePacket last_packet_;
  ExtraBytesDecoder extra_bytes_;
};

}  // namespace

Result<std::unique_ptr<RecordDecoder>> decode_pointwise(const RecordLayout& layout, std::span<const std::byte> chunk) {
  if (chunk.size() < layout.length) return fail(ErrorKind::kInvalidInput, "truncated: a LAZ chunk is too short");
  return std::make_unique<PointwiseDecoder>(layout, chunk);
}

}  // namespace surfcast::laz
