#include "gl/timers.h"

#include <cstring>

#include "gl/context.h"

namespace strandcast::gl {

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

namespace {

constexpr const char* kBegin = "";
constexpr const char* kWhole = "all";
constexpr size_t kMaxPasses = 16;  // marks per frame, its begin included
constexpr size_t kQueriesAtOnce = 16;

}  // namespace

PassTimer::~PassTimer() {
  for (const Mark& mark : marks_) free_.push_back(mark.query);
  if (!free_.empty()) glDeleteQueries(static_cast<GLsizei>(free_.size()), free_.data());
}

void PassTimer::measure(bool each, size_t frames) {
  on_ = true;
  each_ = each;
  by_clock_ = gl::currentIsSoftware();
  marks_.reserve(frames * (each ? kMaxPasses : 2));
  free_.reserve(kQueriesAtOnce);
}

void PassTimer::mark(const char* name) {
  Mark made{name, 0, {}};
  if (by_clock_) {
    glFinish();
    made.when = std::chrono::steady_clock::now();
  } else {
    if (free_.empty()) {
      free_.resize(kQueriesAtOnce);
      glCreateQueries(GL_TIMESTAMP, kQueriesAtOnce, free_.data());
    }
    made.query = free_.back();
    free_.pop_back();
    glQueryCounter(made.query, GL_TIMESTAMP);
  }
  marks_.push_back(made);
}

void PassTimer::begin() {
  if (on_) mark(kBegin);
}

void PassTimer::passed(const char* name) {
  const bool whole = std::strcmp(name, kWhole) == 0;
  if (on_ && each_ != whole) mark(name);
}

std::vector<std::pair<std::string, double>> PassTimer::take() {
  std::vector<std::pair<std::string, double>> out;
  GLuint64 before = 0;
  for (size_t i = 0; i < marks_.size(); ++i) {
    const Mark& mark = marks_[i];
    GLuint64 now = 0;
    if (by_clock_)
      now = static_cast<GLuint64>(
          std::chrono::duration_cast<std::chrono::nanoseconds>(mark.when.time_since_epoch()).count());
    else
      glGetQueryObjectui64v(mark.query, GL_QUERY_RESULT, &now);
    if (mark.name != kBegin) out.emplace_back(mark.name, 1e-6 * static_cast<double>(now - before));
    before = now;
    if (mark.query != 0) free_.push_back(mark.query);
  }
  marks_.clear();
  return out;
}

}  // namespace strandcast::gl
