#pragma once
#include <memory>

namespace strandcast {

/// A pool of threads for layers of a grid or chunks of strands. Results must not depend on which thread runs
/// which item.
class Workers {
 public:
  explicit Workers(int threads);  ///< 0 = all hardware threads
  ~Workers();
  int threads() const { return threads_; }
  /// Calls work(i) for i in 0 .. count - 1, concurrently and in any order; returns when all are done. Does
  /// not allocate.
  template <class Work>
  void forEach(int count, const Work& work) const {
    run(
        count, [](const void* what, int i) { (*static_cast<const Work*>(what))(i); }, &work);
  }

 private:
  struct Arena;
  void run(int count, void (*call)(const void*, int), const void* work) const;

  int threads_;
  std::unique_ptr<Arena> arena_;
};

}  // namespace strandcast
