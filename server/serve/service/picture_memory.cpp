#include "service/picture_memory.h"

#include <utility>

namespace surfcast::service {

PictureMemory::Share::Share(std::shared_ptr<PictureMemory> memory, ClientId client, size_t bytes)
    : memory_(std::move(memory)), client_(client), bytes_(bytes) {
  memory_->change(client_, 0, bytes_);
}

PictureMemory::Share::~Share() {
  memory_->change(client_, bytes_, 0);
}

void PictureMemory::Share::shrink(size_t bytes) {
  if (bytes >= bytes_) return;
  memory_->change(client_, std::exchange(bytes_, bytes), bytes);
}

void PictureMemory::close() {
  const std::lock_guard lock(calling_);
  given_back_ = nullptr;
}

bool PictureMemory::fits(ClientId client, size_t bytes) const {
  const std::lock_guard lock(mutex_);
  const auto found = held_of_.find(client);
  const size_t of_client = found == held_of_.end() ? 0 : found->second;
  const bool in_half = of_client == 0 || of_client + bytes <= limit_ / 2;
  // A tenth more, so that a picture that needs all of it does not wait until no small one is left.
  return in_half && (held_ == 0 || held_ + bytes <= limit_ + limit_ / 10);
}

std::shared_ptr<PictureMemory::Share> PictureMemory::take(ClientId client, size_t bytes) {
  return std::make_shared<Share>(shared_from_this(), client, bytes);
}

size_t PictureMemory::held() const {
  const std::lock_guard lock(mutex_);
  return held_;
}

void PictureMemory::change(ClientId client, size_t before, size_t after) {
  {
    const std::lock_guard lock(mutex_);
    held_ += after - before;
    size_t& of_client = held_of_[client];
    of_client += after - before;
    if (of_client == 0) held_of_.erase(client);
  }
  if (after >= before) return;
  const std::lock_guard lock(calling_);
  if (given_back_) given_back_();
}

}  // namespace surfcast::service
