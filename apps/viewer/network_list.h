#pragma once
#include <future>
#include <memory>
#include <string>
#include <vector>

#include "apps/settings.h"
#include "transport/subscriber.h"

namespace strandcast {

/// The daemons on a network. Listening starts in the background on the first call of listen().
class NetworkList {
 public:
  /// Listens on the network of these settings.
  explicit NetworkList(const Settings& settings) : settings_(settings) {}
  void listen();
  bool listens() const { return subscriber_ != nullptr || joining_.valid(); }
  /// The newest status of each daemon; empty until one was heard.
  std::vector<Status> daemons();
  const std::string& problem() const { return problem_; }  ///< why listening failed; empty otherwise

 private:
  const Settings settings_;
  std::future<std::unique_ptr<Subscriber>> joining_;
  std::unique_ptr<Subscriber> subscriber_;
  std::string problem_;
};

}  // namespace strandcast
