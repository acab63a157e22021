#pragma once
#include <condition_variable>
#include <deque>
#include <map>
#include <mutex>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "transport/lcm/lcm_ends.h"

namespace strandcast {

/// Faults of a link, by seed. Probabilities from 0 to 1.
struct Losses {
  double drop = 0, duplicate = 0;
  double swap = 0;  ///< probability that a message arrives after the one that follows it
  uint32_t seed = 1;
};

/// A network in memory: a thread delivers each message to every listener, with the given losses.
class LossyLink final : public MessageLink {
 public:
  explicit LossyLink(Losses losses = {})
      : losses_(losses), random_(losses.seed), thread_([this] { carry(); }) {}
  ~LossyLink() override {
    {
      const std::lock_guard lock(mutex_);
      stop_ = true;
    }
    changed_.notify_all();
    thread_.join();
  }
  std::vector<Subscription> listen(std::vector<Channel> channels) override {
    const std::lock_guard lock(mutex_);
    std::vector<Subscription> out;
    for (Channel& channel : channels) {
      auto slot = std::make_shared<HandlerSlot>(std::move(channel.handler));
      subscriptions_.emplace(channel.name, slot);
      out.push_back(makeSubscription(std::move(slot)));
    }
    return out;
  }
  void send(const std::string& channel, std::span<const uint8_t> message) override {
    const std::lock_guard lock(mutex_);
    ++sent_;
    if (chance(losses_.drop)) {
      ++dropped_;
      return;
    }
    const int copies = chance(losses_.duplicate) ? 2 : 1;
    for (int i = 0; i < copies; ++i) {
      queue_.push_back({channel, {message.begin(), message.end()}});
      if (queue_.size() > 1 && chance(losses_.swap)) std::swap(queue_.back(), queue_[queue_.size() - 2]);
    }
    changed_.notify_all();
  }
  /// Takes effect from now on.
  void setLosses(const Losses& losses) {
    const std::lock_guard lock(mutex_);
    losses_ = losses;
  }
  /// Waits until all that was sent has been delivered.
  void drain() {
    std::unique_lock lock(mutex_);
    idle_.wait(lock, [&] { return queue_.empty() && !is_busy_; });
  }
  uint64_t dropped() const {
    const std::lock_guard lock(mutex_);
    return dropped_;
  }

 private:
  struct Message {
    std::string channel;
    std::vector<uint8_t> bytes;
  };
  bool chance(double p) { return p > 0 && std::uniform_real_distribution<double>()(random_) < p; }
  void carry() {
    std::unique_lock lock(mutex_);
    for (;;) {
      changed_.wait(lock, [&] { return stop_ || !queue_.empty(); });
      if (stop_) return;
      const Message message = std::move(queue_.front());
      queue_.pop_front();
      is_busy_ = true;
      std::vector<std::shared_ptr<HandlerSlot>> slots;
      for (auto [at, end] = subscriptions_.equal_range(message.channel); at != end; ++at)
        slots.push_back(at->second);
      lock.unlock();
      for (const auto& slot : slots) slot->deliver(message.bytes);
      lock.lock();
      is_busy_ = false;
      idle_.notify_all();
    }
  }

  mutable std::mutex mutex_;
  std::condition_variable changed_, idle_;
  Losses losses_;
  std::mt19937 random_;
  std::multimap<std::string, std::shared_ptr<HandlerSlot>> subscriptions_;
  std::deque<Message> queue_;
  uint64_t sent_ = 0, dropped_ = 0;
  bool stop_ = false, is_busy_ = false;
  std::thread thread_;
};

}  // namespace strandcast
