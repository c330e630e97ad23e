#pragma once

#include <string>
#include <vector>

#include "gl/objects.h"

namespace surfcast::gl {

/// Milliseconds between marks of a frame, taken by the GL itself (GL_TIMESTAMP), so that work that the driver has only
/// queued is charged to the stage that asked for it.
class StageTimer {
 public:
  struct Stage {
    std::string name;
    double milliseconds;
  };

  /// Starts a frame.
  void begin();
  /// Ends the stage that began at the last mark.
  void mark(const char* stage);
  /// Waits for the marks and returns the stages in order.
  std::vector<Stage> collect();

 private:
  void stamp();

  std::vector<Query> queries_;
  std::vector<std::string> names_;
  size_t used_ = 0;
};

}  // namespace surfcast::gl
