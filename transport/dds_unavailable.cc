#include "core/error.h"
#include "transport/dds.h"
#include "transport/publisher.h"

namespace strandcast {
namespace {

const char* const kReason = "built without Fast DDS (libfastrtps-dev or libfastcdr-dev was missing)";

[[noreturn]] void refuse() {
  throw Error("DDS is not available", kReason, "install the packages and build again");
}

}  // namespace

bool ddsAvailable(std::string* reason) {
  if (reason) *reason = kReason;
  return false;
}

std::unique_ptr<Publisher> makeDdsPublisher(const DdsOptions&) { refuse(); }
std::unique_ptr<Subscriber> makeDdsSubscriber(const DdsOptions&) { refuse(); }

}  // namespace strandcast
