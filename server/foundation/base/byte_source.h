#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "base/result.h"

namespace surfcast {

/// A part of a source of bytes.
struct ByteRange {
  uint64_t offset = 0;
  uint64_t size = 0;

  [[nodiscard]] uint64_t end() const { return offset + size; }
  [[nodiscard]] bool contains(const ByteRange& other) const { return offset <= other.offset && other.end() <= end(); }
  bool operator==(const ByteRange&) const = default;
};

/// Bytes that are read at positions: of a file, or of an object in a store. What was opened keeps its content: if it is
/// replaced, reading fails. Safe to use from several threads at once.
class ByteSource {
 public:
  virtual ~ByteSource() = default;

  /// Its path or URL. Errors do not contain it.
  [[nodiscard]] virtual const std::string& name() const = 0;
  /// Bytes of the source when it was opened.
  [[nodiscard]] virtual uint64_t size() const = 0;
  /// Fills `bytes` with what is at `offset`. Waits for a prefetch of this range.
  [[nodiscard]] virtual Status read(uint64_t offset, std::span<std::byte> bytes) const = 0;
  /// Begins to read many ranges, each of which will be read soon, most urgent first. Returns at once. Sources with slow
  /// answers read neighbouring ranges together, so that it pays to name many at a time.
  virtual void prefetch(std::span<const ByteRange> ranges) const = 0;
  /// A range that was prefetched will not be read.
  virtual void forget(const ByteRange& /*range*/) const {}
  /// What tells its content from other content of that name: a new one has another. Empty if nothing does.
  [[nodiscard]] virtual std::string version() const { return {}; }
  /// Of an open file, to pass it to another process; -1: the source is no file.
  [[nodiscard]] virtual int descriptor() const { return -1; }
  /// Finds out whether the source has been replaced, which replaced() says afterwards. Waits for a slow source, and
  /// changes nothing if it does not answer.
  virtual void look_for_replacement() const {}
  /// True once reading has failed with kReplaced. Nothing can be read any more: the source has to be opened anew.
  [[nodiscard]] virtual bool replaced() const { return false; }
};

}  // namespace surfcast
