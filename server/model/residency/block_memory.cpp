#include "residency/block_memory.h"

#include <algorithm>

#include "base/contract.h"

namespace surfcast::residency {
namespace {

constexpr size_t kFirstCapacity = size_t{1} << 20;  // texels: 16 MiB of surfels

}  // namespace

size_t BlockMemory::device_limit() {
  GLint texels = 0;
  glGetIntegerv(GL_MAX_TEXTURE_BUFFER_SIZE, &texels);
  return static_cast<size_t>(texels);
}

/// Allocates the buffer in its full size, if there is enough memory.
void BlockMemory::Texels::take_all(size_t most) {
  memory_ = LazyMemory(most * texel_bytes_);
  if (memory_.bytes().empty()) return;
  buffer_ = gl::adopt_memory(label_, memory_.bytes());
  texture_ = gl::make_buffer_texture(label_, format_, buffer_);
  capacity_ = most;
}

void BlockMemory::Texels::grow(size_t texels, size_t most) {
  SURFCAST_EXPECTS(texels <= most);
  const size_t capacity = std::clamp(std::max(2 * capacity_, texels), std::min(kFirstCapacity, most), most);
  gl::Buffer larger = gl::make_buffer(label_, capacity * texel_bytes_);
  if (capacity_ > 0) {
    glCopyNamedBufferSubData(buffer_.name(), larger.name(), 0, 0, static_cast<GLsizeiptr>(capacity_ * texel_bytes_));
  }
  texture_ = gl::make_buffer_texture(label_, format_, larger);
  buffer_ = std::move(larger);
  capacity_ = capacity;
}

void BlockMemory::Texels::write(size_t first, std::span<const std::byte> bytes, size_t most, bool lazy,
                                UploadRing& ring) {
  const size_t end = first + bytes.size() / texel_bytes_;
  if (capacity_ == 0 && lazy) take_all(most);
  if (end > capacity_) grow(end, most);
  const size_t offset = first * texel_bytes_;
  if (memory_.bytes().empty()) return ring.copy(bytes, buffer_, offset);
  glNamedBufferSubData(buffer_.name(), static_cast<GLintptr>(offset), static_cast<GLsizeiptr>(bytes.size()),
                       bytes.data());
}

void BlockMemory::UploadRing::copy(std::span<const std::byte> bytes, const gl::Buffer& target, size_t offset) {
  if (!buffer_) buffer_ = gl::make_buffer("uploads", kRingBytes, GL_DYNAMIC_STORAGE_BIT);
  while (!bytes.empty()) {
    if (next_ == kRingBytes) next_ = 0;
    const std::span<const std::byte> piece = bytes.first(std::min(bytes.size(), kRingBytes - next_));
    copy_piece(piece, target, offset);
    offset += piece.size();
    bytes = bytes.subspan(piece.size());
  }
}

void BlockMemory::UploadRing::copy_piece(std::span<const std::byte> piece, const gl::Buffer& target, size_t offset) {
  const auto from = static_cast<GLintptr>(next_);
  const auto size = static_cast<GLsizeiptr>(piece.size());
  glNamedBufferSubData(buffer_.name(), from, size, piece.data());
  glCopyNamedBufferSubData(buffer_.name(), target.name(), from, static_cast<GLintptr>(offset), size);
  next_ += piece.size();
}

void BlockMemory::write(size_t first, std::span<const glm::uvec4> surfels) {
  surfels_.write(first, std::as_bytes(surfels), most_, lazy_, ring_);
}

void BlockMemory::write_attributes(size_t first, std::span<const uint32_t> attributes) {
  attributes_.write(first, std::as_bytes(attributes), most_, lazy_, ring_);
}

}  // namespace surfcast::residency
