#include "apps/viewer/network_list.h"

#include <chrono>

#include "apps/channel.h"
#include "core/error.h"

namespace strandcast {

void NetworkList::listen() {
  if (listens()) return;
  problem_.clear();
  joining_ = std::async(std::launch::async, [settings = settings_] { return subscribe(settings); });
}

std::vector<Status> NetworkList::daemons() {
  if (joining_.valid() && joining_.wait_for(std::chrono::seconds(0)) == std::future_status::ready) {
    try {
      subscriber_ = joining_.get();
    } catch (const Error& error) {
      problem_ = error.what();
    }
  }
  return subscriber_ ? subscriber_->allStatuses() : std::vector<Status>{};
}

}  // namespace strandcast
