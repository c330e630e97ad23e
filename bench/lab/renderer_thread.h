#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>

#include "render/renderer.h"

namespace surfcast::lab {

/// A renderer on a thread of its own, on which its GL context stays current: several of them draw in turn.
class RendererThread {
 public:
  /// Ends the program where no renderer can be made.
  explicit RendererThread(const render::RendererConfig& config);
  ~RendererThread();
  RendererThread(const RendererThread&) = delete;
  RendererThread& operator=(const RendererThread&) = delete;

  using Work = std::function<void(render::Renderer&)>;
  /// Does the work on the thread, and returns when it is done.
  void run(const Work& work);

 private:
  void loop(const render::RendererConfig& config);

  std::mutex mutex_;
  std::condition_variable changed_;
  const Work* work_ = nullptr;
  bool ending_ = false;
  std::thread thread_;
};

}  // namespace surfcast::lab
