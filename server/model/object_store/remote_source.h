#pragma once

#include <memory>
#include <string>

#include "object_store/http_client.h"

namespace surfcast::object_store {

/// An object of a store, read by ranges. Its version is that of the first answer: later answers must have it.
///
/// Ranges that were announced by `prefetch` are joined (join_ranges) and requested at once, several requests at a time;
/// what arrives waits in memory until it is read. `read` of any other range is a request of its own. If the store does
/// not answer a request in time, those that wait behind it fail, too: they would take as long.
class RemoteSource : public ByteSource {
 public:
  /// Reads the beginning of the object. `name`: for errors. The client must outlive the source.
  static Result<std::unique_ptr<RemoteSource>> open(const HttpClient& client, const StorePlace& place,
                                                    const std::string& name);
  ~RemoteSource() override;

  [[nodiscard]] const std::string& name() const override;
  [[nodiscard]] uint64_t size() const override;
  [[nodiscard]] Status read(uint64_t offset, std::span<std::byte> bytes) const override;
  void prefetch(std::span<const ByteRange> ranges) const override;
  void forget(const ByteRange& range) const override;
  [[nodiscard]] std::string version() const override;
  void look_for_replacement() const override;
  [[nodiscard]] bool replaced() const override;

 private:
  class State;
  explicit RemoteSource(std::shared_ptr<State> state);
  std::shared_ptr<State> state_;
};

}  // namespace surfcast::object_store
