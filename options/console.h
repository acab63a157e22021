#pragma once
#include <nlohmann/json_fwd.hpp>

#include <atomic>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace strandcast {

/// Set by SIGINT and SIGTERM instead of ending the process; loops poll it and end cleanly.
extern std::atomic<bool> g_interrupted;
/// Installs the signal handlers.
void catchInterrupts();

}  // namespace strandcast

namespace CLI {
class App;
}

namespace strandcast {

/// Exit codes of every program; 0 is success.
constexpr int kExitCheckFailed = 1;
constexpr int kExitBadInput = 2;
constexpr int kExitInterrupted = 130;

/// Ctrl-C came before there was anything to close. Thrown up to runProgram().
struct Interrupted {};

/// Serialises on one line. Bytes of names that are not valid UTF-8, e.g. of files, become U+FFFD.
std::string jsonText(const nlohmann::json& value);

/// A progress bar on standard error; silent where that is not a terminal.
class ProgressBar {
 public:
  ProgressBar();
  ~ProgressBar();
  /// `part`: progress, 0 to 1.
  void show(const std::string& what, double part);
  /// Erases the bar until the next show(), so that other lines can be printed.
  void clear();

 private:
  bool shown_ = false;
  bool terminal_ = false;
};

/// During its lifetime the log lines of this thread begin with a label: "ada: refused ...". Of several
/// characters in one process each has its own. Labels do not nest: the newest counts, then none.
class LogLabel {
 public:
  /// An empty label is none.
  explicit LogLabel(const std::string& label);
  ~LogLabel();
  LogLabel(const LogLabel&) = delete;
  LogLabel& operator=(const LogLabel&) = delete;
  /// The label of this thread, for threads that it starts.
  static const std::string& current();
};
/// Makes the default logger print labels. Not thread-safe.
void printLogLabels();

/// Named values, printed as a table for people or as one JSON object.
class Report {
 public:
  /// `key`: in JSON. `label`: in the table.
  void add(const std::string& key, const std::string& label, const std::string& text);
  void add(const std::string& key, const std::string& label, double value, const std::string& unit,
           int digits);
  void addCount(const std::string& key, const std::string& label, uint64_t value);
  void print(bool json) const;  ///< to standard output
  std::string json() const;     ///< one JSON object

 private:
  struct Row {
    std::string key, label, text, json;
  };
  std::vector<Row> rows_;
};

/// The exit code of a program; 2, with a line on standard error, where standard output could not be written.
/// A closed pipe (`| head`) is not a failure.
int withOutputWritten(int exit_code);

/// All options of `app`, named `program`, and of its verbs as sections of a Markdown page, with the tables of
/// parameters and materials. Options that strandcastd or an earlier section has are only named.
std::string markdownHelp(const CLI::App& app, const std::string& program);

/// Parses a program's arguments into `app`. Returns an exit code where the program must end: after help, or
/// on an unknown argument. The single argument --help-markdown, which no help lists, prints markdownHelp().
std::optional<int> parseArguments(CLI::App& app, int argc, const char* const* argv);

/// Runs a program's body. An Error or another exception becomes one line on standard error and exit code 2;
/// Interrupted or BakeStopped exit code 130; otherwise as withOutputWritten().
int runProgram(const std::function<int()>& body);

}  // namespace strandcast
