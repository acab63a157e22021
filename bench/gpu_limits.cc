#include "bench/machine.h"

#ifdef STRANDCAST_HAS_RENDER
#include <algorithm>
#include <chrono>

#include "bench/shaders.h"
#include "gl/buffer.h"
#include "gl/current.h"
#include "gl/program.h"
#include "gl/timers.h"
#else
#include "core/error.h"
#endif

namespace strandcast {
#ifdef STRANDCAST_HAS_RENDER

namespace {

constexpr GLuint kWorkgroup = 256;    // of both shaders
constexpr double kMultiplyAdds = 64;  // per invocation and round
constexpr int kAttempts = 6;
constexpr std::chrono::milliseconds kClocksRise(400);  // time for an idle GPU to raise its clocks

/// The minimum time of `work`, a sequence of dispatches, s.
template <class Work>
double minSeconds(int attempts, const Work& work) {
  gl::PassTimer timer;
  timer.measure(false, static_cast<size_t>(attempts));
  for (int attempt = 0; attempt < attempts; ++attempt) {
    timer.begin();
    work();
    glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
    timer.passed("all");
  }
  double least = 1e30;
  for (const auto& [name, ms] : timer.take()) least = std::min(least, 1e-3 * ms);
  return least;
}

/// The same after the GPU has reached its full clock rate; a software OpenGL needs no warm-up.
template <class Work>
double minSecondsAtFullSpeed(bool is_software, const Work& work) {
  const auto start = std::chrono::steady_clock::now();
  double least = minSeconds(kAttempts, work);
  while (!is_software && std::chrono::steady_clock::now() - start < kClocksRise)
    least = std::min(least, minSeconds(kAttempts, work));
  return least;
}

double multiplyAddsPerSecond(bool is_software) {
  constexpr GLuint kGroups = 4096;      // more workgroups than any GPU runs at once
  constexpr double kLongEnough = 4e-3;  // s, against which launch overhead is negligible
  const gl::Program program("multiply_adds", {{GL_COMPUTE_SHADER, shaders::kMultiplyAddsComp}});
  const gl::Buffer sums(sizeof(float) * kGroups * kWorkgroup, nullptr, 0);
  sums.bindStorage(0);
  program.use();
  program.set("by_and_plus", Eigen::Vector2f(0.999f, 1e-3f));
  const auto add = [&] { glDispatchCompute(kGroups, 1, 1); };
  const auto secondsOf = [&](int rounds) {
    program.set("rounds", rounds);
    return minSeconds(1, add);
  };
  secondsOf(1);  // some drivers compile on first use
  int rounds = 1;
  while (rounds < (1 << 20) && secondsOf(rounds) < kLongEnough) rounds *= 2;
  return 2 * kMultiplyAdds * kGroups * kWorkgroup * rounds / minSecondsAtFullSpeed(is_software, add);
}

double copiedBytesPerSecond(bool is_software) {
  constexpr GLuint kGroups = 16384;
  // Five times the cache of an H100. A software OpenGL is far slower than its memory and would take seconds.
  const GLint64 wanted = (is_software ? 32 : 256) << 20;
  GLint64 most = 0;
  glGetInteger64v(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &most);
  const auto bytes = static_cast<size_t>(std::min(wanted, most));
  const gl::Program program("buffer_copy", {{GL_COMPUTE_SHADER, shaders::kBufferCopyComp}});
  const gl::Buffer from(bytes, nullptr, 0), to(bytes, nullptr, 0);
  constexpr float kSomething = 1;
  glClearNamedBufferData(from.id(), GL_R32F, GL_RED, GL_FLOAT, &kSomething);  // allocates
  from.bindStorage(0);
  to.bindStorage(1);
  program.use();
  const auto copy = [&] { glDispatchCompute(kGroups, 1, 1); };
  minSeconds(1, copy);  // some drivers compile and allocate memory on first use
  return 2 * static_cast<double>(bytes) / minSecondsAtFullSpeed(is_software, copy);
}

}  // namespace

GpuLimits measuredGpuLimits() {
  gl::HeadlessContext context;
  const gl::MakeCurrent current(context);
  return {multiplyAddsPerSecond(context.software()), copiedBytesPerSecond(context.software())};
}

#else

GpuLimits measuredGpuLimits() {
  throw Error("this build has no OpenGL", "--backend gpu", "install libepoxy-dev and build again");
}

#endif
}  // namespace strandcast
