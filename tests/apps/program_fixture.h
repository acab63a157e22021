#pragma once
#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <string>
#include <thread>
#include <vector>

namespace strandcast {

/// The exit code as a shell reports it, or 1000 plus the signal that ended the process.
inline int exitCodeOf(int wait_status) {
  return WIFEXITED(wait_status) ? WEXITSTATUS(wait_status) : 1000 + WTERMSIG(wait_status);
}

/// The content of a file.
inline std::string contents(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// A cube of edge 0.1 units as .obj.
inline const std::string kCube =
    "v 0 0 0\nv 0.1 0 0\nv 0.1 0.1 0\nv 0 0.1 0\nv 0 0 0.1\nv 0.1 0 0.1\nv 0.1 0.1 0.1\nv 0 0.1 0.1\n"
    "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 3 4 8 7\nf 2 3 7 6\nf 4 1 5 8\n";

/// The results of a program that has ended.
struct Outcome {
  int exit_code = -1;
  std::string out, err;
};

/// Runs programs as a user does, in a temporary folder. Programs that still run at the end of the test are
/// killed, also where the test process itself is killed (PR_SET_PDEATHSIG).
class ProgramFixture : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() /
              ("strandcast_" + std::to_string(getpid()) + "_" +
               ::testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override {
    for (const pid_t child : running_) kill(child, SIGKILL);
    while (!running_.empty()) wait(*running_.begin());
    std::filesystem::remove_all(folder_);
  }

  std::filesystem::path write(const std::string& name, const std::string& bytes) {
    std::ofstream(folder_ / name, std::ios::binary) << bytes;
    return folder_ / name;
  }
  /// Runs a line in a shell and waits for its end.
  Outcome run(const std::string& command) {
    const auto out = folder_ / "out.txt", err = folder_ / "err.txt";
    const int status = std::system((command + " >" + out.string() + " 2>" + err.string()).c_str());
    return {exitCodeOf(status), contents(out), contents(err)};
  }

  /// Starts a program in the folder without waiting for it; its output goes to the file `out` there.
  pid_t start(std::vector<std::string> words, const std::string& out) {
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    const pid_t child = fork();
    if (child == 0) {
      prctl(PR_SET_PDEATHSIG, SIGKILL);
      if (chdir(folder_.c_str()) != 0) _exit(126);
      const int file = open(out.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
      if (file < 0 || dup2(file, STDOUT_FILENO) < 0) _exit(126);
      execvp(arguments[0], arguments.data());
      _exit(127);
    }
    running_.insert(child);
    return child;
  }
  /// Sends SIGINT once the program handles it: a program that starts slowly must not die of the default
  /// action.
  void interrupt(pid_t child) {
    for (int i = 0; i < 600 && !catchesInterrupts(child) && isRunning(child); ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    kill(child, SIGINT);
  }
  int wait(pid_t child) {
    int status = 0;
    running_.erase(child);
    waitpid(child, &status, 0);
    return exitCodeOf(status);
  }
  bool isRunning(pid_t child) {
    siginfo_t ended{};
    return waitid(P_PID, static_cast<id_t>(child), &ended, WEXITED | WNOHANG | WNOWAIT) == 0 &&
           ended.si_pid == 0;
  }

  std::filesystem::path folder_;
  const std::string daemon_ = STRANDCAST_DAEMON, program_ = STRANDCAST_PROGRAM;

 private:
  static bool catchesInterrupts(pid_t child) {
    std::ifstream status("/proc/" + std::to_string(child) + "/status");
    for (std::string line; std::getline(status, line);)
      if (line.rfind("SigCgt:", 0) == 0) return std::stoull(line.substr(7), nullptr, 16) >> (SIGINT - 1) & 1;
    return false;
  }

  std::set<pid_t> running_;
};

}  // namespace strandcast
