#include "core/error.h"
#include "transport/lcm.h"

namespace strandcast {

std::string lcmUrl(int domain) {
  if (domain < 0 || domain > 232)
    throw Error("the domain is out of range", std::to_string(domain), "choose 0 to 232");
  return "udpm://239.255.76.67:" + std::to_string(7667 + domain) + "?ttl=0";
}

bool isLcmLog(const std::string& url) { return url.starts_with("file://"); }

}  // namespace strandcast
