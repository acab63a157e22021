#include "gpu_compute/pass_timer.h"

#include <cstring>

#include "gl/context.h"

namespace strandcast::gpu {
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

}  // namespace strandcast::gpu
