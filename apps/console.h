#pragma once
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace CLI {
class App;
}

namespace strandcast {

/// Exit codes of every program: 0 done, and
constexpr int kExitCheckFailed = 1;
constexpr int kExitBadInput = 2;
constexpr int kExitInterrupted = 130;

/// Ctrl-C came before there was anything to end in order. Thrown up to runProgram().
struct Interrupted {};

/// In one line. Bytes of names that are no UTF-8, as those of files may be, become U+FFFD.
std::string jsonText(const nlohmann::json& value);

/// A progress bar on standard error; quiet when that is not a terminal.
class ProgressBar {
 public:
  ProgressBar();
  ~ProgressBar();
  void show(const std::string& what, double part);
  /// Takes it away until it is shown again, so that other lines can be printed.
  void clear();

 private:
  bool shown_ = false;
  bool terminal_ = false;
};

/// Named values, printed as a table for people or as one JSON object.
class Report {
 public:
  void add(const std::string& key, const std::string& label, const std::string& text);
  void add(const std::string& key, const std::string& label, double value, const std::string& unit,
           int digits);
  void addCount(const std::string& key, const std::string& label, uint64_t value);
  void print(bool json) const;  ///< on standard output

 private:
  struct Row {
    std::string key, label, text, json;
  };
  std::vector<Row> rows_;
};

/// What a program returns at its end: the exit code, or 2, with a line on standard error, where what it
/// printed on standard output did not get there. That nobody reads on (`| head`) is no failure.
int withOutputWritten(int exit_code);

/// Reads a program's arguments into `app`. The exit code where the program ends with it: it was asked for
/// help, or told what it does not know.
std::optional<int> parseArguments(CLI::App& app, int argc, const char* const* argv);

/// Runs a program's body: an Error or a stray exception becomes one line on standard error and exit code 2,
/// Interrupted or a BakeStopped exit code 130, else as withOutputWritten().
int runProgram(const std::function<int()>& body);

}  // namespace strandcast
