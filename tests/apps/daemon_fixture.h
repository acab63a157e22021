#pragma once
#include <gtest/gtest.h>

#include <atomic>
#include <memory>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "scenes/scene.h"
#include "service/daemon.h"
#include "transport/in_process.h"

namespace strandcast {

/// A daemon with few short strands on a still head, and its reader, over the in-process channel.
class DaemonFixture : public ::testing::Test {
 protected:
  static Settings fewStrands() {
    Settings settings;
    settings.scene.name = "straight";
    settings.scene.strands = 20;
    settings.scene.vertices = 8;
    settings.scene.motion = "still";
    settings.backend = "reference";
    return settings;
  }
  void start(const Settings& settings, Scene scene) {
    std::tie(publisher_, subscriber_) = makeInProcessChannel(settings.groom_id);
    daemon_ = std::make_unique<Daemon>(settings, std::move(scene), *publisher_, newSession());
    daemon_->announce();
  }
  /// Sends a command and returns the daemon's answer.
  std::string order(CommandKind kind, std::vector<double> values, const std::string& name = "") {
    const Command command{.id = ++id_, .kind = kind, .name = name, .values = std::move(values)};
    subscriber_->send(command);
    cast(1);
    return subscriber_->waitForAnswer(command.id, std::chrono::milliseconds(1000)).value_or("no answer");
  }
  void cast(int frames) {
    for (int i = 0; i < frames; ++i) daemon_->castFrame(stop_);
  }

  std::unique_ptr<Publisher> publisher_;
  std::unique_ptr<Subscriber> subscriber_;
  std::unique_ptr<Daemon> daemon_;

 private:
  const std::atomic<bool> stop_{false};
  uint64_t id_ = 0;
};

}  // namespace strandcast
