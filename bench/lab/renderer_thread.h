#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>

#include "render/renderer.h"

namespace surfcast::lab {

/// A renderer on its own thread, on which its GL context stays current. Several renderers can take turns.
class RendererThread {
 public:
  /// Exits the program if the renderer cannot be created.
  explicit RendererThread(const render::RendererConfig& config);
  ~RendererThread();
  RendererThread(const RendererThread&) = delete;
  RendererThread& operator=(const RendererThread&) = delete;

  using Work = std::function<void(render::Renderer&)>;
  /// Runs the work on the thread and waits until it is done.
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
