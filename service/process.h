// Processes: their processor time, and this program as a child of its own.
#pragma once
#include <sys/resource.h>
#include <sys/types.h>

#include <chrono>
#include <optional>
#include <string>
#include <vector>

namespace strandcast {

/// Processor time used so far, s, user and kernel. `whose`: RUSAGE_SELF, all threads of this process, or
/// RUSAGE_THREAD, the calling thread.
inline double processorSeconds(int whose) {
  rusage used{};
  getrusage(whose, &used);
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  return seconds(used.ru_utime) + seconds(used.ru_stime);
}

/// Runs this program once more as a child process. The destructor ends the child.
class ChildProcess {
 public:
  /// Starts the program with these arguments; it shares standard error. Throws Error.
  explicit ChildProcess(std::vector<std::string> words);
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  /// The child's output up to the end of the next line. Empty where the child ends first, prints nothing
  /// within `patience`, or this program is interrupted; end() then describes the outcome.
  std::optional<std::string> line(std::chrono::milliseconds patience);
  /// Closes the child's standard input, as the end of this program would.
  void endInput();
  /// Ends the child at once, as a crash would. What it has printed can still be read.
  void kill();
  /// Closes the child's input, and kills it where it still runs two seconds later. Returns how it ended, as
  /// text.
  std::string end();

 private:
  pid_t pid_ = 0;
  int input_ = -1, output_ = -1;
  std::string read_;  // output beyond the last line
};

/// In the child: whether endInput() was called or the parent is gone. Precondition: nothing is written to its
/// input.
bool inputHasEnded();

}  // namespace strandcast
