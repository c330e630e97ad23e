#include "worker/shared_board.h"

#include <cerrno>
#include <cstring>
#include <new>
#include <string>

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>

namespace surfcast::worker {
namespace {

constexpr size_t kPage = 4096;

constexpr size_t whole_pages(size_t bytes) {
  return (bytes + kPage - 1) / kPage * kPage;
}

tl::unexpected<Error> memory_error(const char* what) {
  return fail(ErrorKind::kIo, std::string(what) + ": " + std::strerror(errno));
}

}  // namespace

Result<SharedBoard> SharedBoard::create(size_t pixel_bytes) {
  Descriptor memory(::memfd_create("surfcast-pictures", MFD_CLOEXEC | MFD_ALLOW_SEALING));
  if (!memory) return memory_error("cannot make shared memory");
  const size_t size = whole_pages(sizeof(Head)) + whole_pages(pixel_bytes);
  if (::ftruncate(memory.get(), static_cast<off_t>(size)) != 0) return memory_error("cannot size shared memory");
  // A worker that made the file shorter would end the server with SIGBUS.
  if (::fcntl(memory.get(), F_ADD_SEALS, F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_SEAL) != 0) {
    return memory_error("cannot seal shared memory");
  }
  Result<SharedBoard> board = map(std::move(memory), size);
  if (board) new (board->head_) Head{};
  return board;
}

Result<SharedBoard> SharedBoard::adopt(Descriptor memory) {
  struct stat information {};
  if (::fstat(memory.get(), &information) != 0) return memory_error("cannot use shared memory");
  const auto size = static_cast<size_t>(information.st_size);
  if (size < whole_pages(sizeof(Head))) return fail(ErrorKind::kInvalidInput, "the shared memory is too small");
  return map(std::move(memory), size);
}

Result<SharedBoard> SharedBoard::map(Descriptor memory, size_t size) {
  void* const address = ::mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_SHARED, memory.get(), 0);
  if (address == MAP_FAILED) return memory_error("cannot map shared memory");
  return SharedBoard(std::move(memory), size, address);
}

SharedBoard::~SharedBoard() {
  if (head_ != nullptr) ::munmap(head_, size_);
}

std::span<std::byte> SharedBoard::pixels() const {
  const size_t begin = whole_pages(sizeof(Head));
  return {reinterpret_cast<std::byte*>(head_) + begin, size_ - begin};
}

void SharedBoard::release_pixels(size_t bytes) const {
  ::fallocate(memory_.get(), FALLOC_FL_PUNCH_HOLE | FALLOC_FL_KEEP_SIZE, whole_pages(sizeof(Head)),
              static_cast<off_t>(whole_pages(bytes)));
}

size_t SharedBoard::note(const BoardBlock& block) const {
  for (size_t i = 0; i < kBoardSlots; ++i) {
    Slot& slot = head_->slots[i];
    bool taken = false;
    if (!slot.taken.compare_exchange_strong(taken, true)) continue;
    slot.model = block.model;
    slot.block = block.block;
    slot.filled = true;
    return i;
  }
  return kBoardSlots;
}

void SharedBoard::clear(size_t slot) const {
  if (slot >= kBoardSlots) return;
  head_->slots[slot].filled = false;
  head_->slots[slot].taken = false;
}

std::vector<BoardBlock> SharedBoard::loading() const {
  std::vector<BoardBlock> blocks;
  for (const Slot& slot : head_->slots) {
    if (slot.filled) blocks.push_back({slot.model, slot.block});
  }
  return blocks;
}

}  // namespace surfcast::worker
