#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <utility>

#include "service/client_shares.h"

namespace surfcast::service {

/// The memory of pictures, from the beginning of drawing until their files have been taken by their clients, within a
/// limit. Thread-safe.
class PictureMemory : public std::enable_shared_from_this<PictureMemory> {
 public:
  /// Memory of one picture, which is given back when it is destroyed.
  class Share {
   public:
    Share(std::shared_ptr<PictureMemory> memory, ClientId client, size_t bytes);
    ~Share();
    Share(const Share&) = delete;
    Share& operator=(const Share&) = delete;

    /// The picture needs only so much from now on; more than before is not taken.
    void shrink(size_t bytes);

   private:
    std::shared_ptr<PictureMemory> memory_;
    ClientId client_;
    size_t bytes_;
  };

  /// `given_back` is called after memory was given back, from the thread that did, until close().
  PictureMemory(size_t limit, std::function<void()> given_back) : limit_(limit), given_back_(std::move(given_back)) {}
  void close();

  /// Whether a picture of so many bytes may be begun: a client has half of the limit, or one picture, and all have the
  /// limit and a tenth. A picture that is larger than that needs the memory for itself.
  [[nodiscard]] bool fits(ClientId client, size_t bytes) const;
  [[nodiscard]] std::shared_ptr<Share> take(ClientId client, size_t bytes);
  /// Bytes that are taken.
  [[nodiscard]] size_t held() const;

 private:
  void change(ClientId client, size_t before, size_t after);

  const size_t limit_;
  mutable std::mutex mutex_;
  size_t held_ = 0;
  std::map<ClientId, size_t> held_of_;
  std::mutex calling_;
  std::function<void()> given_back_;
};

}  // namespace surfcast::service
