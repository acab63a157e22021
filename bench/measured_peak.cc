// Compiled once per instruction set: Highway's foreach_target includes this file again for each.
#include <chrono>
#include <thread>
#include <vector>

#include "bench/bench_simulation.h"
#include "bench/machine.h"
#include "kernels/highway_targets.h"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "bench/measured_peak.cc"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace strandcast::peak::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Returns the number of operations in `rounds` rounds; `sink` keeps the compiler from removing them. Ten
/// chains hide the latency of two units. Each chain has its own initial value, or compilers merge them.
double multiplyAdds(long rounds, float* sink) {
  const hn::ScalableTag<float> tag;
  const auto by = hn::Set(tag, 0.999f), plus = hn::Set(tag, 1e-3f);
  auto a = hn::Set(tag, 0.1f), b = hn::Set(tag, 0.2f), c = hn::Set(tag, 0.3f), d = hn::Set(tag, 0.4f),
       e = hn::Set(tag, 0.5f), f = hn::Set(tag, 0.6f), g = hn::Set(tag, 0.7f), h = hn::Set(tag, 0.8f),
       i = hn::Set(tag, 0.9f), j = hn::Set(tag, 1.1f);
  for (long round = 0; round < rounds; ++round) {
    a = hn::MulAdd(a, by, plus);
    b = hn::MulAdd(b, by, plus);
    c = hn::MulAdd(c, by, plus);
    d = hn::MulAdd(d, by, plus);
    e = hn::MulAdd(e, by, plus);
    f = hn::MulAdd(f, by, plus);
    g = hn::MulAdd(g, by, plus);
    h = hn::MulAdd(h, by, plus);
    i = hn::MulAdd(i, by, plus);
    j = hn::MulAdd(j, by, plus);
  }
  const auto sum = hn::Add(hn::Add(hn::Add(a, b), hn::Add(c, d)),
                           hn::Add(hn::Add(e, f), hn::Add(hn::Add(g, h), hn::Add(i, j))));
  *sink = hn::GetLane(sum);
  return 20.0 * static_cast<double>(rounds) * static_cast<double>(hn::Lanes(tag));
}

}  // namespace strandcast::peak::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace strandcast {
namespace peak {
HWY_EXPORT(multiplyAdds);
double run(long rounds, float* sink) { return HWY_DYNAMIC_DISPATCH(multiplyAdds)(rounds, sink); }
}  // namespace peak

double measuredPeak(int threads) {
  constexpr long kRounds = 20'000'000;
  double best = 0;
  for (int attempt = 0; attempt < 5; ++attempt) {
    std::vector<float> sinks(threads);
    std::vector<double> done(threads);
    const auto start = std::chrono::steady_clock::now();
    std::vector<std::thread> others;
    auto work = [&](int t) { done[t] = peak::run(kRounds, &sinks[t]); };
    for (int t = 1; t < threads; ++t) others.emplace_back(work, t);
    work(0);
    for (std::thread& other : others) other.join();
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    double all = 0;
    for (const double one : done) all += one;
    best = std::max(best, all / seconds);
  }
  return best;
}

double measuredPeakOfProcessor() {
  constexpr long kRounds = 10'000'000;
  double best = 0;
  for (int attempt = 0; attempt < 8; ++attempt) {
    float sink = 0;
    const double before = processorMs();
    const double done = peak::run(kRounds, &sink);
    best = std::max(best, done / (1e-3 * (processorMs() - before)));
  }
  return best;
}

}  // namespace strandcast
#endif
