#include "transport/lcm/lcm_link.h"

#include <arpa/inet.h>
#include <spdlog/spdlog.h>

#include <cerrno>
#include <charconv>
#include <cstring>
#include <string_view>

#include "core/error.h"
#include "transport/lcm/lcm_ends.h"

namespace strandcast {
namespace {

constexpr std::string_view kMulticast = "udpm://";
constexpr const char* kReceiveBuffer =
    "recv_buf_size=4194304";  // bytes; with the default, bursts of a frame are lost
/// Messages of a channel that may wait for the drain thread: enough for frames of two million vertices.
constexpr int kQueued = 1024;
constexpr int kPollMs = 50;

std::string completed(const std::string& url) {
  if (!url.starts_with(kMulticast) || url.find("recv_buf_size") != std::string::npos) return url;
  return url + (url.find('?') == std::string::npos ? "?" : "&") + kReceiveBuffer;
}

/// LCM 1.3.1 accepts any text as an address, and port 0.
void checkMulticast(const std::string& url, const std::string& place) {
  if (place.empty()) return;  // LCM's default
  const size_t colon = place.find(':');
  const std::string address = place.substr(0, colon);
  in_addr parsed{};
  if (inet_pton(AF_INET, address.c_str(), &parsed) != 1 || ntohl(parsed.s_addr) >> 28 != 14)
    throw Error("'" + address + "' is no multicast address", url,
                "give 224.0.0.0 to 239.255.255.255, e.g. udpm://239.255.76.67:7667?ttl=0");
  if (colon == std::string::npos) return;
  const std::string port = place.substr(colon + 1);
  uint16_t number = 0;
  const auto [rest, failure] = std::from_chars(port.data(), port.data() + port.size(), number);
  if (rest != port.data() + port.size() || failure != std::errc() || number == 0)
    throw Error("'" + port + "' is no UDP port", url, "give 1 to 65535");
}

[[noreturn]] void fail(const std::string& url) {
  if (url.starts_with(kMulticast)) {
    throw Error("LCM cannot use multicast", url,
                "it needs a route: `ip link set lo multicast on; ip route add 224.0.0.0/4 dev lo` for this "
                "machine alone, or dev and name of a network interface");
  }
  if (isLcmLog(url)) throw Error("LCM cannot open its log file", url, "check path and mode (r or w)");
  throw Error("not an LCM URL", url, "give udpm://ADDRESS:PORT?ttl=N, file:///PATH?mode=w or memq://");
}

}  // namespace

LcmLink::LcmLink(const std::string& url) : url_(url) {
  if (url.starts_with(kMulticast))
    checkMulticast(url, url.substr(kMulticast.size(), url.find('?') - kMulticast.size()));
  const bool is_known = url.starts_with(kMulticast) || isLcmLog(url) || url.starts_with("memq://");
  if (is_known) lcm_ = lcm_create(completed(url).c_str());
  if (lcm_ == nullptr) fail(url);
}

LcmLink::~LcmLink() {
  stop_ = true;
  if (drain_.joinable()) drain_.join();
  lcm_destroy(lcm_);
}

std::vector<MessageLink::Subscription> LcmLink::listen(std::vector<Channel> channels) {
  const auto receive = [](const lcm_recv_buf_t* message, const char*, void* slot) {
    static_cast<HandlerSlot*>(slot)->deliver(
        {static_cast<const uint8_t*>(message->data), message->data_size});
  };
  const std::lock_guard lock(mutex_);
  std::vector<Subscription> out;
  for (Channel& channel : channels) {
    subscriptions_.push_back(std::make_shared<HandlerSlot>(std::move(channel.handler)));
    lcm_subscription_t* subscription =
        lcm_subscribe(lcm_, channel.name.c_str(), receive, subscriptions_.back().get());
    if (subscription == nullptr) fail(url_);
    lcm_subscription_set_queue_capacity(subscription, kQueued);
    out.push_back(makeSubscription(subscriptions_.back()));
  }
  if (!drain_.joinable()) drain_ = std::thread([this] { drain(); });
  return out;
}

void LcmLink::send(const std::string& channel, std::span<const uint8_t> message) {
  errno = 0;
  const int result =
      lcm_publish(lcm_, channel.c_str(), message.data(), static_cast<unsigned>(message.size()));
  // A message that the network refuses counts as lost. LCM 1.3.1 returns 0 even where it cannot write a log.
  const int cause = errno;
  if (!isWrittenLog(url_) || (result == 0 && cause == 0)) return;
  const std::lock_guard lock(mutex_);
  if (!failure_.empty()) return;
  failure_ = Error(std::string("the LCM log cannot be written (") + std::strerror(cause) + ")", url_,
                   "is the disk full?")
                 .what();
  spdlog::error("{}", failure_);
}

std::string LcmLink::failure() const {
  const std::lock_guard lock(mutex_);
  return failure_;
}

void LcmLink::drain() {
  // Below 0: the log file has ended.
  while (!stop_ && lcm_handle_timeout(lcm_, kPollMs) >= 0) {
  }
}

}  // namespace strandcast
