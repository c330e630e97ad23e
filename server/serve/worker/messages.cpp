#include "worker/messages.h"

#include <utility>

#include "worker/structure_fields.h"

namespace surfcast::worker {

template <typename Archive, Is<Configure> T>
void fields(Archive& archive, T& value) {
  auto& [renderer, log_format, sandbox, readable, writable] = value;
  archive(renderer, log_format, sandbox, readable, writable);
}

template <typename Archive, Is<Ready> T>
void fields(Archive& archive, T& value) {
  auto& [device, max_resolution] = value;
  archive(device, max_resolution);
}

template <typename Archive, Is<OfferModel> T>
void fields(Archive& archive, T& value) {
  auto& [model, path, quarantined, suspected] = value;
  archive(model, path, quarantined, suspected);
}

template <typename Archive, Is<OfferJoin::Part> T>
void fields(Archive& archive, T& value) {
  auto& [model, name, places] = value;
  archive(model, name, places);
}

template <typename Archive, Is<OfferJoin> T>
void fields(Archive& archive, T& value) {
  auto& [model, parts, path, quarantined, suspected] = value;
  archive(model, parts, path, quarantined, suspected);
}

template <typename Archive, Is<WithdrawModel> T>
void fields(Archive& archive, T& value) {
  archive(value.model);
}

template <typename Archive, Is<Draw> T>
void fields(Archive& archive, T& value) {
  auto& [model, request] = value;
  archive(model, request);
}

template <typename Archive, Is<AskUrgent> T>
void fields(Archive& /*archive*/, T& /*value*/) {}

template <typename Archive, Is<Continue> T>
void fields(Archive& archive, T& value) {
  archive(value.preempted);
}

template <typename Archive, Is<Drawn> T>
void fields(Archive& archive, T& value) {
  auto& [frame, pixels] = value;
  archive(frame, pixels);
}

template <typename Archive, Is<Refused> T>
void fields(Archive& archive, T& value) {
  archive(value.error);
}

template <typename Archive, Is<ConfigureQueries> T>
void fields(Archive& archive, T& value) {
  auto& [log_format, sandbox, readable, block_bytes, memory] = value;
  archive(log_format, sandbox, readable, block_bytes, memory);
}

template <typename Archive, Is<Pick> T>
void fields(Archive& archive, T& value) {
  auto& [model, query] = value;
  archive(model, query);
}

template <typename Archive, Is<Picked> T>
void fields(Archive& archive, T& value) {
  archive(value.item);
}

template <typename Archive, Is<SearchSurface> T>
void fields(Archive& archive, T& value) {
  auto& [model, query] = value;
  archive(model, query);
}

template <typename Archive, Is<SurfacePart> T>
void fields(Archive& archive, T& value) {
  archive(value.pixels);
}

template <typename Archive, Is<FindBand> T>
void fields(Archive& archive, T& value) {
  auto& [model, query] = value;
  archive(model, query);
}

template <typename Archive, Is<BandPart> T>
void fields(Archive& archive, T& value) {
  auto& [total, length, grid, points, values, last] = value;
  archive(total, length, grid, points, values, last);
}

template <typename Archive, Is<OpenPoints> T>
void fields(Archive& archive, T& value) {
  auto& [stream, model, query] = value;
  archive(stream, model, query);
}

template <typename Archive, Is<CountPoints> T>
void fields(Archive& archive, T& value) {
  archive(value.stream);
}

template <typename Archive, Is<PointsCounted> T>
void fields(Archive& archive, T& value) {
  auto& [facts, whole] = value;
  archive(facts, whole);
}

template <typename Archive, Is<NextPiece> T>
void fields(Archive& archive, T& value) {
  auto& [stream, bytes] = value;
  archive(stream, bytes);
}

template <typename Archive, Is<PointsPiece> T>
void fields(Archive& archive, T& value) {
  archive(value.piece);
}

template <typename Archive, Is<ClosePoints> T>
void fields(Archive& archive, T& value) {
  archive(value.stream);
}

namespace {

/// Makes `message` the alternative of that number, and reads it. False if there is none.
template <size_t Alternative = 0>
bool read_alternative(ArchiveReader& archive, uint8_t number, Message& message) {
  if constexpr (Alternative < std::variant_size_v<Message>) {
    if (number != Alternative) return read_alternative<Alternative + 1>(archive, number, message);
    archive(message.emplace<Alternative>());
    return archive.complete();
  } else {
    return false;
  }
}

}  // namespace

Error checked(Error error) {
  if (error.kind < ErrorKind::kInvalidInput || error.kind > ErrorKind::kInternal) error.kind = ErrorKind::kInternal;
  return error;
}

std::vector<std::byte> encode(const Message& message) {
  ArchiveWriter archive;
  archive(static_cast<uint8_t>(message.index()));
  std::visit([&archive](const auto& value) { archive(value); }, message);
  return std::move(archive).take();
}

Result<Message> decode(std::span<const std::byte> bytes) {
  ArchiveReader archive(bytes);
  uint8_t number = 0;
  archive(number);
  Message message;
  if (read_alternative(archive, number, message)) return message;
  return fail(ErrorKind::kInvalidInput, "these bytes are no message");
}

}  // namespace surfcast::worker
