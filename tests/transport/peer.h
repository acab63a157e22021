#pragma once
#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

namespace strandcast {

using Results = std::map<std::string, double>;

/// Sets an environment variable for the peers that are started during its lifetime.
class PeerSetting {
 public:
  PeerSetting(const char* name, const std::string& value) : name_(name) { setenv(name, value.c_str(), 1); }
  ~PeerSetting() { unsetenv(name_); }
  PeerSetting(const PeerSetting&) = delete;
  PeerSetting& operator=(const PeerSetting&) = delete;

 private:
  const char* name_;
};

/// A transport_peer process, or another program. The destructor kills it if it still runs.
class Peer {
 public:
  explicit Peer(std::vector<std::string> arguments, const std::string& program = STRANDCAST_TRANSPORT_PEER) {
    arguments.insert(arguments.begin(), program);
    std::vector<char*> pointers;
    for (std::string& argument : arguments) pointers.push_back(argument.data());
    pointers.push_back(nullptr);
    int ends[2];
    if (pipe2(ends, O_CLOEXEC) != 0) throw std::runtime_error("pipe");
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
    posix_spawn_file_actions_adddup2(&actions, ends[1], STDERR_FILENO);
    if (posix_spawn(&pid_, program.c_str(), &actions, nullptr, pointers.data(), environ) != 0) {
      throw std::runtime_error(program + " cannot be started");
    }
    posix_spawn_file_actions_destroy(&actions);
    close(ends[1]);
    output_ = fdopen(ends[0], "r");
  }
  ~Peer() {
    kill();
    std::fclose(output_);
  }
  Peer(const Peer&) = delete;
  Peer& operator=(const Peer&) = delete;

  void kill() {
    if (pid_ <= 0) return;
    ::kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
    pid_ = 0;
  }
  /// Reads until this key was printed; false when the peer ended first.
  bool waitFor(const std::string& key) {
    while (!results_.contains(key) && readLine()) {
    }
    return results_.contains(key);
  }
  /// All results, after the peer has ended.
  const Results& finish() {
    while (readLine()) {
    }
    int status = 0;
    waitpid(pid_, &status, 0);
    pid_ = 0;
    exit_code_ = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    return results_;
  }
  /// Kills the peer and describes its state, for the message of a failed test.
  std::string exitReport() {
    int status = 0;
    const bool had_ended = waitpid(pid_, &status, WNOHANG) == pid_;
    if (had_ended) pid_ = 0;
    kill();
    while (readLine()) {
    }
    return (had_ended ? "had ended with wait status " + std::to_string(status) : std::string("was alive")) +
           ", said:\n" + text_;
  }
  pid_t pid() const { return pid_; }
  const Results& results() const { return results_; }
  int exitCode() const { return exit_code_; }
  const std::string& text() const { return text_; }

 private:
  bool readLine() {
    char line[512], key[64];
    double value = 0;
    if (!std::fgets(line, sizeof line, output_)) return false;
    text_ += line;
    if (std::sscanf(line, "%63s %lf", key, &value) == 2) results_[key] = value;
    return true;
  }
  pid_t pid_ = 0;
  FILE* output_ = nullptr;
  Results results_;
  std::string text_;
  int exit_code_ = -1;
};

}  // namespace strandcast
