#include "lab/renderer_thread.h"

#include "bench_support.h"

namespace surfcast::lab {

RendererThread::RendererThread(const render::RendererConfig& config) : thread_([this, config] { loop(config); }) {}

RendererThread::~RendererThread() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void RendererThread::run(const Work& work) {
  std::unique_lock lock(mutex_);
  work_ = &work;
  changed_.notify_all();
  changed_.wait(lock, [this] { return work_ == nullptr; });
}

void RendererThread::loop(const render::RendererConfig& config) {
  const std::unique_ptr<render::Renderer> renderer = bench::value_or_exit(render::Renderer::create(config));
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [this] { return work_ != nullptr || ending_; });
    if (ending_) return;
    (*work_)(*renderer);
    work_ = nullptr;
    changed_.notify_all();
  }
}

}  // namespace surfcast::lab
