#pragma once
#include <sys/types.h>

#include <chrono>
#include <optional>
#include <string>
#include <vector>

namespace strandcast {

/// This program once more, as another process. It ends with this.
class SecondProcess {
 public:
  /// Runs it with these words; its standard error is this program's. Throws Error.
  explicit SecondProcess(std::vector<std::string> words);
  ~SecondProcess();
  SecondProcess(const SecondProcess&) = delete;
  SecondProcess& operator=(const SecondProcess&) = delete;

  /// What it prints until the end of the next line. Nothing when it ends before, says nothing for so long, or
  /// this program is interrupted: end() says what became of it.
  std::optional<std::string> line(std::chrono::milliseconds patience);
  /// Ends its standard input, as the end of this program does.
  void endInput();
  /// Ends its input, and kills it where it still runs two seconds later; how it ended, for people.
  std::string end();

 private:
  pid_t pid_ = 0;
  int input_ = -1, output_ = -1;
  std::string read_;  // beyond the last line
};

/// In the second process: whether endInput() was called, or the first one is gone.
bool inputHasEnded();

}  // namespace strandcast
