#include "gl/stage_timer.h"

namespace surfcast::gl {

void StageTimer::stamp() {
  if (used_ == queries_.size()) {
    GLuint name = 0;
    glCreateQueries(GL_TIMESTAMP, 1, &name);
    queries_.emplace_back(name);
  }
  glQueryCounter(queries_[used_++].name(), GL_TIMESTAMP);
}

void StageTimer::begin() {
  used_ = 0;
  names_.clear();
  stamp();
}

void StageTimer::mark(const char* stage) {
  names_.emplace_back(stage);
  stamp();
}

std::vector<StageTimer::Stage> StageTimer::collect() {
  std::vector<GLuint64> stamps(used_);
  for (size_t i = 0; i < used_; ++i) glGetQueryObjectui64v(queries_[i].name(), GL_QUERY_RESULT, &stamps[i]);
  std::vector<Stage> stages;
  for (size_t i = 0; i < names_.size(); ++i) {
    stages.push_back({names_[i], static_cast<double>(stamps[i + 1] - stamps[i]) * 1e-6});
  }
  return stages;
}

}  // namespace surfcast::gl
