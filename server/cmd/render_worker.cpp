#include "cmd/render_worker.h"

#include <filesystem>
#include <system_error>

#include "base/descriptor.h"
#include "worker/run_worker.h"

namespace surfcast::cmd {

Result<std::vector<std::string>> render_worker_command() {
  std::error_code code;
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", code);
  if (code) return fail(ErrorKind::kIo, "cannot find the program itself: " + code.message());
  return std::vector<std::string>{program.string(), kRenderWorker};
}

void run_render_worker() {
  worker::run_worker(Descriptor(worker::kWorkerSocket), Descriptor(worker::kWorkerMemory));
}

}  // namespace surfcast::cmd
