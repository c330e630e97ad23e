#include "cmd/worker_role.h"

#include <filesystem>
#include <string_view>
#include <system_error>
#include <utility>

#include "base/descriptor.h"
#include "worker/run_worker.h"

namespace surfcast::cmd {

Result<std::vector<std::string>> worker_command(const char* purpose) {
  std::error_code code;
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", code);
  if (code) return fail(ErrorKind::kIo, "cannot find the program itself: " + code.message());
  return std::vector<std::string>{program.string(), purpose};
}

void run_as_worker(int argc, char** argv) {
  const std::string_view purpose = argc == 2 ? argv[1] : "";
  if (purpose != kRenderWorker && purpose != kQueryWorker) return;
  Descriptor socket(worker::kWorkerSocket);
  Descriptor memory(worker::kWorkerMemory);
  if (purpose == kQueryWorker) worker::run_query_worker(std::move(socket), std::move(memory));
  worker::run_worker(std::move(socket), std::move(memory));
}

}  // namespace surfcast::cmd
