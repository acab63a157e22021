#pragma once
#include <memory>

namespace strandcast {

/// Threads that share the layers of a grid or chunks of strands. Results must not depend on who does what.
class Workers {
 public:
  explicit Workers(int threads);  ///< 0 = all of the machine
  ~Workers();
  int threads() const { return threads_; }
  /// work(i) for i in 0 .. count - 1, in any order, at the same time. Does not allocate.
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
