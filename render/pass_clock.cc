#include "render/pass_clock.h"

#include "gl/context.h"

namespace strandcast {

PassClock::PassClock() : by_processor_(gl::currentIsSoftware()) {}

PassClock::~PassClock() { glDeleteQueries(static_cast<GLsizei>(queries_.size()), queries_.data()); }

void PassClock::stamp() {
  if (by_processor_) {
    glFinish();
    clocks_.resize(stamps_++);
    clocks_.push_back(std::chrono::steady_clock::now());
    return;
  }
  if (stamps_ == queries_.size()) {
    queries_.push_back(0);
    glCreateQueries(GL_TIMESTAMP, 1, &queries_.back());
  }
  glQueryCounter(queries_[stamps_++], GL_TIMESTAMP);
}

double PassClock::milliseconds(size_t from) const {
  if (from + 1 >= stamps_) return 0;
  if (by_processor_)
    return std::chrono::duration<double, std::milli>(clocks_[from + 1] - clocks_[from]).count();
  GLuint64 begin = 0, end = 0;
  glGetQueryObjectui64v(queries_[from], GL_QUERY_RESULT, &begin);
  glGetQueryObjectui64v(queries_[from + 1], GL_QUERY_RESULT, &end);
  return end > begin ? 1e-6 * static_cast<double>(end - begin) : 0;
}

}  // namespace strandcast
