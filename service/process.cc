#include "service/process.h"

#include <errno.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <thread>
#include <utility>

#include "core/error.h"
#include "options/console.h"

namespace strandcast {
namespace {

using std::chrono::milliseconds;
using Clock = std::chrono::steady_clock;

constexpr const char* kThisProgram = "/proc/self/exe";
constexpr int kPollMs = 100;
constexpr milliseconds kGrace{2000};  // time that a process has to leave its network

[[noreturn]] void fail() {
  throw Error("a second process cannot be started", kThisProgram,
              "are there too many processes or open files?");
}

void closeOnce(int& file) {
  if (file >= 0) close(std::exchange(file, -1));
}

}  // namespace

ChildProcess::ChildProcess(std::vector<std::string> words) {
  words.insert(words.begin(), program_invocation_short_name);
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  int in[2] = {-1, -1}, out[2] = {-1, -1};
  if (pipe2(in, O_CLOEXEC) != 0) fail();
  input_ = in[1];
  if (pipe2(out, O_CLOEXEC) != 0) {
    close(in[0]);
    closeOnce(input_);
    fail();
  }
  output_ = out[0];
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, in[0], STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&actions, out[1], STDOUT_FILENO);
  const bool started = posix_spawn(&pid_, kThisProgram, &actions, nullptr, arguments.data(), environ) == 0;
  posix_spawn_file_actions_destroy(&actions);
  close(in[0]);
  close(out[1]);
  if (!started) {
    closeOnce(input_);
    closeOnce(output_);
    fail();
  }
}

ChildProcess::~ChildProcess() {
  if (pid_ != 0) end();
}

std::optional<std::string> ChildProcess::line(milliseconds patience) {
  const Clock::time_point deadline = Clock::now() + patience;
  for (;;) {
    if (const size_t at = read_.find('\n'); at != std::string::npos) {
      std::string line = read_.substr(0, at);
      read_.erase(0, at + 1);
      return line;
    }
    pollfd waiting{output_, POLLIN, 0};
    if (poll(&waiting, 1, kPollMs) > 0) {
      char bytes[4096];
      const ssize_t count = read(output_, bytes, sizeof bytes);
      if (count > 0)
        read_.append(bytes, static_cast<size_t>(count));
      else if (count == 0 || errno != EINTR)
        return std::nullopt;
    }
    if (g_interrupted || Clock::now() > deadline) return std::nullopt;
  }
}

void ChildProcess::endInput() { closeOnce(input_); }

void ChildProcess::kill() { ::kill(pid_, SIGKILL); }

std::string ChildProcess::end() {
  endInput();
  if (g_interrupted) ::kill(pid_, SIGTERM);
  int status = 0;
  pid_t ended = 0;
  const Clock::time_point deadline = Clock::now() + kGrace;
  while ((ended = waitpid(pid_, &status, WNOHANG)) == 0 && Clock::now() < deadline)
    std::this_thread::sleep_for(milliseconds(5));
  if (ended == 0) {
    ::kill(pid_, SIGKILL);
    waitpid(pid_, &status, 0);
  }
  pid_ = 0;
  closeOnce(output_);
  if (ended == 0) return "was still running";
  if (WIFSIGNALED(status)) return fmt::format("was ended by signal {}", WTERMSIG(status));
  return fmt::format("ended with exit code {}", WEXITSTATUS(status));
}

bool inputHasEnded() {
  pollfd input{STDIN_FILENO, POLLIN, 0};
  return poll(&input, 1, 0) > 0;
}

}  // namespace strandcast
