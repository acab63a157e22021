#include "core/error.h"
#include "transport/lcm.h"
#include "transport/publisher.h"

namespace strandcast {
namespace {

const char* const kReason = "built without LCM (liblcm-dev or libglib2.0-dev was missing)";

[[noreturn]] void refuse() {
  throw Error("LCM is not available", kReason, "install the packages and build again");
}

}  // namespace

bool lcmAvailable(std::string* reason) {
  if (reason) *reason = kReason;
  return false;
}

std::unique_ptr<Publisher> makeLcmPublisher(const LcmOptions&) { refuse(); }
std::unique_ptr<Subscriber> makeLcmSubscriber(const LcmOptions&) { refuse(); }
std::unique_ptr<PoseSender> makeLcmPoseSender(const LcmOptions&, const std::vector<uint32_t>&) { refuse(); }
std::pair<std::unique_ptr<Publisher>, std::unique_ptr<Subscriber>> makeLcmChannel(const LcmOptions&) {
  refuse();
}

}  // namespace strandcast
