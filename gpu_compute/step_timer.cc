#include "gpu_compute/step_timer.h"

namespace strandcast::gpu {
namespace {

constexpr GLuint64 kNothing =
    1000;  // ns; less is no measurement: llvmpipe measures the recording of commands only

}  // namespace

StepTimer::StepTimer() {
  glCreateQueries(GL_TIME_ELAPSED, static_cast<GLsizei>(queries_.size()), queries_.data());
}

StepTimer::~StepTimer() { glDeleteQueries(static_cast<GLsizei>(queries_.size()), queries_.data()); }

void StepTimer::begin() {
  poll();
  running_ = asked_ - answered_ < queries_.size();
  if (running_) glBeginQuery(GL_TIME_ELAPSED, queries_[asked_ % queries_.size()]);
}

void StepTimer::end() {
  if (!running_) return;
  glEndQuery(GL_TIME_ELAPSED);
  ++asked_;
}

void StepTimer::poll() {
  while (answered_ < asked_) {
    const GLuint query = queries_[answered_ % queries_.size()];
    GLuint there = GL_FALSE;
    glGetQueryObjectuiv(query, GL_QUERY_RESULT_AVAILABLE, &there);
    if (there == GL_FALSE) return;
    GLuint64 nanoseconds = 0;
    glGetQueryObjectui64v(query, GL_QUERY_RESULT, &nanoseconds);
    newest_ = nanoseconds > kNothing ? std::optional(1e-9 * static_cast<double>(nanoseconds)) : std::nullopt;
    ++answered_;
  }
}

}  // namespace strandcast::gpu
