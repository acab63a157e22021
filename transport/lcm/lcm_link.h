#pragma once
#include <lcm/lcm.h>

#include <atomic>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "transport/lcm/lcm_ends.h"

namespace strandcast {

/// An LCM instance with a thread that drains it, so that messages do not wait in LCM's own queue behind slow
/// work.
class LcmLink final : public MessageLink {
 public:
  /// Throws Error.
  explicit LcmLink(const std::string& url);
  ~LcmLink() override;
  std::vector<Subscription> listen(std::vector<Channel> channels) override;
  /// A message that a log file does not accept is an error, logged once.
  void send(const std::string& channel, std::span<const uint8_t> message) override;
  std::string failure() const override;

 private:
  void drain();
  const std::string url_;
  lcm_t* lcm_ = nullptr;
  mutable std::mutex mutex_;  // guards subscriptions_ and failure_
  std::vector<std::shared_ptr<HandlerSlot>> subscriptions_;
  std::string failure_;
  std::atomic<bool> stop_{false};
  std::thread drain_;  // started by the first listen()
};

}  // namespace strandcast
