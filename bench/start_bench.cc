#include "bench/verbs.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bench/bench_simulation.h"
#include "bench/reader_process.h"
#include "core/error.h"
#include "core/quantile.h"
#include "options/console.h"
#include "transport/dds.h"
#include "transport/lcm.h"

namespace strandcast {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

struct StartOptions {
  std::string scene = "straight";
  int strands = 500, starts = 5;
  fs::path daemon;
  PrintOptions print;
};

/// The path of strandcastd: in this program's folder, or in the sibling folder of a build.
fs::path daemonOf(const StartOptions& o) {
  if (!o.daemon.empty()) return o.daemon;
  const fs::path here = fs::canonical("/proc/self/exe").parent_path();
  for (const fs::path& daemon : {here / "strandcastd", here / "../apps/strandcastd"})
    if (fs::exists(daemon)) return daemon;
  throw Error("strandcastd is not in the folder of this program", here.string(),
              "give its path with --daemon");
}

/// A child process; the destructor interrupts it and waits for its end.
class Program {
 public:
  explicit Program(std::vector<std::string> words) : begun_(Clock::now()) {
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    posix_spawn_file_actions_t quiet;
    posix_spawn_file_actions_init(&quiet);
    posix_spawn_file_actions_addopen(&quiet, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    const int failed = posix_spawn(&pid_, words[0].c_str(), &quiet, nullptr, arguments.data(), environ);
    posix_spawn_file_actions_destroy(&quiet);
    if (failed != 0) throw Error("the program cannot be started", words[0], "does the file exist?");
  }
  ~Program() {
    if (pid_ > 0) kill(pid_, SIGINT);
    awaitEnd();
  }
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;
  void awaitEnd() {
    if (pid_ > 0) waitpid(pid_, nullptr, 0);
    pid_ = 0;
  }
  double milliseconds() const {
    return std::chrono::duration<double, std::milli>(Clock::now() - begun_).count();
  }

 private:
  Clock::time_point begun_;
  pid_t pid_ = 0;
};

std::vector<std::string> wordsOf(const StartOptions& o) {
  return {daemonOf(o).string(), "--scene", o.scene, "--strands", std::to_string(o.strands), "--quiet"};
}

/// ms from exec to the end of a daemon that writes one frame to an LCM log, where it waits for no other
/// daemons.
double loadingMs(const StartOptions& o) {
  const fs::path log = fs::temp_directory_path() / fmt::format("strandbench_start_{}.log", getpid());
  std::vector<std::string> words = wordsOf(o);
  words.insert(words.end(), {"--transport", "lcm", "--lcm-url", "file://" + log.string() + "?mode=w",
                             "--duration", "0.001"});
  Program daemon(words);
  daemon.awaitEnd();
  const double ms = daemon.milliseconds();
  fs::remove(log);
  return ms;
}

/// ms from exec until a subscriber that exists before has the daemon's first frame.
double startMs(const StartOptions& o, bool claims) {
  const auto reader = makeDdsSubscriber({benchDomain(), 1, 0, {}});
  std::vector<std::string> words = wordsOf(o);
  words.insert(words.end(), {"--domain", std::to_string(benchDomain())});
  if (claims) words.insert(words.end(), {"--claim", "1"});
  const Program daemon(words);
  constexpr std::chrono::seconds kFirstFrameWait{60};
  if (!reader->waitForFrame(0, kFirstFrameWait))
    throw Error("no frame received", words[0], "does it run on its own?");
  return daemon.milliseconds();
}

int start(const StartOptions& o) {
  std::string reason;
  if (!ddsAvailable(&reason)) throw Error(reason, "strandbench start", "");
  Bench bench;
  bench.name = "start";
  bench.params = {{"scene", o.scene}, {"strands", o.strands}, {"starts", o.starts}};
  bench.heading = fmt::format("{} of {} strands: time from exec to the first frame in another process\n",
                              o.scene, o.strands);
  bench.table = Table({{"claim", "claim"},
                       {"starts", "starts"},
                       {"loading_ms", "loading ms", "{:.0f}"},
                       {"first_frame_ms", "first frame ms", "{:.0f}"},
                       {"first_frame_ms_max", "at most", "{:.0f}"},
                       {"ratio", "ratio", "{:.2f}"}});
  ProgressBar bar;
  for (const bool claims : {false, true}) {
    std::vector<double> loading, starts;
    for (int i = 0; i < o.starts; ++i) {
      bar.show(claims ? "with --claim" : "alone", static_cast<double>(i) / o.starts);
      if (lcmAvailable()) loading.push_back(loadingMs(o));
      starts.push_back(startMs(o, claims));
    }
    nlohmann::json row{{"claim", claims ? "yes" : "no"},
                       {"starts", o.starts},
                       {"first_frame_ms", quantileOf(starts, 0.5)},
                       {"first_frame_ms_max", quantileOf(starts, 1.0)}};
    if (!loading.empty()) {
      row["loading_ms"] = quantileOf(loading, 0.5);
      row["ratio"] = quantileOf(starts, 0.5) / quantileOf(loading, 0.5);
    }
    bench.table.add(row);
  }
  bar.clear();
  print(bench, o.print);
  return 0;
}

}  // namespace

std::function<int()> addStartBench(CLI::App& app) {
  const auto o = std::make_shared<StartOptions>();
  app.footer(
      "Loading: from exec to exit of the same program publishing into an LCM log, where it does not listen "
      "for other\n"
      "daemons. Ratio: the start over the network to loading. A daemon listens while it loads, so the ratio "
      "is near 1\n"
      "if loading takes longer than listening (0.4 s; 0.8 s with --claim).\n"
      "Examples:\n"
      "  strandbench start\n"
      "  strandbench start --scene curly --strands 5000 --starts 3");
  addScene(app, o->scene);
  addStrands(app, o->strands);
  app.add_option("--starts", o->starts, "starts of each kind; the table has medians")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  app.add_option("--daemon", o->daemon, "path of strandcastd; default: in the folder of this program");
  addPrintOptions(app, o->print);
  return [o] { return start(*o); };
}

}  // namespace strandcast
