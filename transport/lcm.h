#pragma once
#include <memory>
#include <string>
#include <utility>

#include "transport/codec/codec.h"
#include "transport/publisher.h"
#include "transport/subscriber.h"

namespace strandcast {

struct LcmOptions {
  /// "udpm://ADDRESS:PORT?ttl=N", "file:///PATH?mode=w" (a publisher's; lcm-logplayer or a subscriber with
  /// mode=r replay it) or "memq://" (makeLcmChannel only).
  std::string url;
  uint32_t groom_id = 1;
  uint64_t session = 0;  ///< publisher only: of this start, not 0
  CodecOptions codec;    ///< publisher only; not kTemporal over udpm, which loses messages
  bool frames = true;    ///< subscriber only: as DdsOptions::frames
};

/// Whether this build has LCM, and why not.
bool lcmAvailable(std::string* reason = nullptr);

/// Multicast on this machine only (ttl=0), on a port of its own for each domain, 0 to 232.
std::string lcmUrl(int domain);
/// Whether it is of a log: a file, in which there is nobody else.
bool isLcmLog(const std::string& url);

/// LCM over UDP multicast loses what the network loses and has no security: for networks that are trusted.
/// Readers conceal what is lost. The groom is repeated every second, and at once for a reader that asks. A
/// daemon that was silent for 3 s counts as gone; so does a reader.
///
/// All throw Error on options out of range and when LCM cannot be set up, most often for want of a route for
/// multicast: the Error says how to add one.
std::unique_ptr<Publisher> makeLcmPublisher(const LcmOptions& options);
std::unique_ptr<Subscriber> makeLcmSubscriber(const LcmOptions& options);
/// Both ends on one LCM instance, which memq:// needs.
std::pair<std::unique_ptr<Publisher>, std::unique_ptr<Subscriber>> makeLcmChannel(const LcmOptions& options);

}  // namespace strandcast
