#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "object_store/join_ranges.h"

namespace surfcast::object_store {

/// Who signs requests to a store that speaks S3. Without a key they are not signed.
struct Credentials {
  std::string key;      ///< ID of the access key
  std::string secret;   ///< its secret
  std::string session;  ///< token of temporary credentials; empty: they are not temporary

  [[nodiscard]] bool known() const { return !key.empty() && !secret.empty(); }
};

/// How stores are asked, and for how long.
struct StoreConfig {
  /// For one read, from when it is asked for, with all that is tried again; with time to draw it is ten seconds.
  std::chrono::milliseconds timeout{8'000};
  std::chrono::milliseconds connect_timeout{3'000};  ///< for one connection
  std::chrono::milliseconds stall_timeout{3'000};    ///< without a byte of an answer
  /// Bytes each second of an answer that is waited for beyond `timeout`; 0: none is.
  uint64_t least_rate = uint64_t{8} << 10;
  unsigned retries = 3;  ///< after the first request, of what may succeed later
  /// Lines a minute that the log has of requests that failed, with their URLs, which errors do not contain then; 0: any
  /// number. Without a number there are none, and errors say all.
  std::optional<size_t> log_lines{};
  size_t requests = 16;                         ///< at a time, to all stores together
  uint64_t buffer_bytes = uint64_t{256} << 20;  ///< of one model: read ahead, or being read
  uint64_t listing_bytes = uint64_t{16} << 20;  ///< of a page that lists objects
  JoinLimits join{};
  std::string endpoint{};               ///< of a store that speaks S3, a URL; empty: Amazon's
  std::string region = "us-east-1";     ///< of that store
  std::filesystem::path authorities{};  ///< certificates in PEM; empty: those of the system
  Credentials credentials{};
};

/// Takes credentials, region and endpoint from the variables that all tools for S3 read (AWS_ACCESS_KEY_ID and so on).
void read_environment(StoreConfig& config);

}  // namespace surfcast::object_store
