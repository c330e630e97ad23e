#include "cmd/store_flags.h"

#include "cmd/settings.h"
#include "protocol/request_flags.h"

namespace surfcast::cmd {
namespace {

constexpr uint64_t kMaxRange = uint64_t{1} << 30;

void add_time_flags_of_store(CLI::App& command, object_store::StoreConfig& store) {
  add_seconds(command, "store-timeout", store.timeout,
              "For a part of a model in a store, from when it is asked for, with all that is tried again (default 8). "
              "More: pictures wait for stores that do not answer; less: slow ones are given up");
  add_seconds(command, "store-connect-timeout", store.connect_timeout,
              "For a connection to a store (default 3). More and less as for --store-timeout");
  add_seconds(command, "store-stall-timeout", store.stall_timeout,
              "Without a byte of a store's answer before it is asked again (default 3). More: hanging connections cost "
              "more time; less: slow stores are asked twice");
  add_size(command, "store-least-rate", store.least_rate,
           "Bytes each second of an answer that is waited for beyond --store-timeout (default 8K; 0: none is). More: "
           "slow networks fail; less: pictures wait for them",
           {0, 1 << 30});
  add_count(command, "store-retries", store.retries,
            "Times that a store is asked again which is busy or does not answer (default 3). More: load on a busy "
            "store; less: pictures fail sooner",
            {0, 100});
}

}  // namespace

void add_store_flags(CLI::App& command, object_store::StoreConfig& store) {
  object_store::read_environment(store);
  command
      .add_option("--s3-endpoint", store.endpoint,
                  "URL of the store that s3://BUCKET/KEY is in (default: AWS_ENDPOINT_URL, else Amazon's)")
      ->envname(protocol::environment_name("s3-endpoint"))
      ->type_name("URL");
  command.add_option("--s3-region", store.region, "Its region (default: AWS_REGION, else us-east-1)")
      ->envname(protocol::environment_name("s3-region"))
      ->type_name("NAME");
  command
      .add_option("--store-authorities", store.authorities,
                  "Certificates in PEM by which stores are known (default: those of the system)")
      ->envname(protocol::environment_name("store-authorities"))
      ->type_name("FILE")
      ->check(CLI::ExistingFile);
  add_time_flags_of_store(command, store);
  add_count(command, "store-requests", store.requests,
            "Requests to stores at a time (default 16). More: connections and load on the store; less: it waits for "
            "each answer more often",
            {1, 1024});
  add_size(
      command, "store-buffer", store.buffer_bytes,
      "Bytes of one model that are on their way or wait to be decoded (default 256M). More: memory; less: pictures "
      "of many blocks wait more often");
  add_size(command, "store-gap", store.join.gap,
           "Bytes between two blocks that are read with them to save a request (default 256K). More: bytes in vain; "
           "less: requests",
           {0, kMaxRange});
  add_size(command, "store-run", store.join.run,
           "Blocks read by one request (default 4M). More: the first block of a request waits for the last; less: "
           "requests",
           {1, kMaxRange});
  add_count(command, "store-waste", store.join.waste_percent,
            "Percent of the blocks' bytes that are read between them at most (default 20). More: bytes in vain; less: "
            "requests",
            {0, 10'000});
  add_size(command, "store-listing", store.listing_bytes,
           "The list of a folder in a store (default 16M). More: memory of wrong answers; less: large folders are "
           "refused");
}

void add_block_cache_flag(CLI::App& command, uint64_t& bytes) {
  add_size(
      command, "block-cache", bytes,
      "Blocks of models in stores that are kept on this disk, in the folder --cache (default 0: none). More: disk; "
      "less: blocks are fetched again",
      {0, UINT64_MAX});
}

Result<std::shared_ptr<model::BlockCache>> open_block_cache(uint64_t bytes, const ScanCacheConfig& scans) {
  if (bytes == 0) return nullptr;
  return ready_cache_folder(scans).and_then(
      [bytes](const std::filesystem::path& folder) { return model::BlockCache::open(folder / "blocks", bytes); });
}

}  // namespace surfcast::cmd
