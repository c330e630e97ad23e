#include "model/counted_memory.h"

#include <atomic>
#include <cstdlib>
#include <new>

#include <malloc.h>

namespace surfcast::model {
namespace {

std::atomic<size_t> in_use{0};
std::atomic<size_t> peak{0};

void* count(void* memory) {
  if (memory == nullptr) throw std::bad_alloc();
  const size_t now = in_use += ::malloc_usable_size(memory);
  size_t before = peak;
  while (before < now && !peak.compare_exchange_weak(before, now)) {
  }
  return memory;
}

void* count_aligned(size_t size, std::align_val_t alignment) {
  const auto step = static_cast<size_t>(alignment);
  return count(std::aligned_alloc(step, (size + step - 1) / step * step));
}

void release(void* memory) {
  if (memory != nullptr) in_use -= ::malloc_usable_size(memory);
  std::free(memory);
}

}  // namespace

size_t bytes_in_use() {
  return in_use;
}

size_t peak_bytes_in_use() {
  return peak;
}

void start_peak() {
  peak = in_use.load();
}

}  // namespace surfcast::model

// All forms of the operators that programs and libraries call. The forms that do not throw may terminate the process
// instead of returning null: these tests never run out of memory.

void* operator new(size_t size) {
  return surfcast::model::count(std::malloc(size));
}
void* operator new[](size_t size) {
  return surfcast::model::count(std::malloc(size));
}
void* operator new(size_t size, const std::nothrow_t& /*unused*/) noexcept {
  return surfcast::model::count(std::malloc(size));
}
void* operator new[](size_t size, const std::nothrow_t& /*unused*/) noexcept {
  return surfcast::model::count(std::malloc(size));
}
void* operator new(size_t size, std::align_val_t alignment) {
  return surfcast::model::count_aligned(size, alignment);
}
void* operator new[](size_t size, std::align_val_t alignment) {
  return surfcast::model::count_aligned(size, alignment);
}

void operator delete(void* memory) noexcept {
  surfcast::model::release(memory);
}
void operator delete[](void* memory) noexcept {
  surfcast::model::release(memory);
}
void operator delete(void* memory, size_t /*size*/) noexcept {
  surfcast::model::release(memory);
}
void operator delete[](void* memory, size_t /*size*/) noexcept {
  surfcast::model::release(memory);
}
void operator delete(void* memory, const std::nothrow_t& /*unused*/) noexcept {
  surfcast::model::release(memory);
}
void operator delete[](void* memory, const std::nothrow_t& /*unused*/) noexcept {
  surfcast::model::release(memory);
}
void operator delete(void* memory, std::align_val_t /*alignment*/) noexcept {
  surfcast::model::release(memory);
}
void operator delete[](void* memory, std::align_val_t /*alignment*/) noexcept {
  surfcast::model::release(memory);
}
void operator delete(void* memory, size_t /*size*/, std::align_val_t /*alignment*/) noexcept {
  surfcast::model::release(memory);
}
void operator delete[](void* memory, size_t /*size*/, std::align_val_t /*alignment*/) noexcept {
  surfcast::model::release(memory);
}
