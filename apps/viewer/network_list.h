#pragma once
#include <future>
#include <memory>
#include <string>
#include <vector>

#include "apps/settings.h"
#include "transport/subscriber.h"

namespace strandcast {

/// The daemons on a network, listened for in the background once asked.
class NetworkList {
 public:
  /// Of the network of these settings.
  explicit NetworkList(const Settings& settings) : settings_(settings) {}
  void listen();
  bool listens() const { return subscriber_ != nullptr || joining_.valid(); }
  /// The newest status of each; empty until some were heard.
  std::vector<Status> daemons();
  const std::string& problem() const { return problem_; }  ///< why there is no listening

 private:
  const Settings settings_;
  std::future<std::unique_ptr<Subscriber>> joining_;
  std::unique_ptr<Subscriber> subscriber_;
  std::string problem_;
};

}  // namespace strandcast
