// Public API
#pragma once
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "transport/codec/codec.h"
#include "transport/pose_sender.h"
#include "transport/subscriber.h"

namespace strandcast {

class Publisher;  // transport/publisher.h: the daemon's end, which is not public

/// Options of both ends; makeLcmPublisher() and makeLcmSubscriber() check them.
struct LcmOptions {
  /// "udpm://ADDRESS:PORT?ttl=N", "file:///PATH?mode=w" (publisher: a log, replayed by lcm-logplayer or by a
  /// subscriber with mode=r) or "memq://" (makeLcmChannel only).
  std::string url;
  uint32_t groom_id = 1;
  uint64_t session = 0;  ///< publisher only: random per start, not 0
  CodecOptions codec;    ///< publisher only; not kTemporal over udpm, which loses messages
  bool frames = true;    ///< subscriber only: as DdsOptions::frames
};

/// Whether this build has LCM; if not, `reason` is set.
bool lcmAvailable(std::string* reason = nullptr);

/// URL of multicast on this machine only (ttl=0), port 7667 + domain; domain: 0 to 232.
std::string lcmUrl(int domain);
/// Whether the URL names a log file, which has no other participants.
bool isLcmLog(const std::string& url);

/// LCM over UDP multicast has neither repair nor security: use it on trusted networks only. Readers conceal
/// lost strands. The publisher repeats the groom every second, and at once for a reader that asks. A daemon,
/// or a reader, that was silent for 3 s counts as gone.
///
/// A sender of poses moves the head and bodies of options.groom_id and of further grooms that one character
/// wears (its beard). Each message has the newest three samples, because nothing repeats a lost one.
///
/// All throw Error on options out of range and when LCM cannot be set up, most often because multicast has no
/// route: the Error says how to add one.
std::unique_ptr<Publisher> makeLcmPublisher(const LcmOptions& options);
std::unique_ptr<Subscriber> makeLcmSubscriber(const LcmOptions& options);
std::unique_ptr<PoseSender> makeLcmPoseSender(const LcmOptions& options,
                                              const std::vector<uint32_t>& further_grooms = {});
/// Both ends on one LCM instance, as memq:// requires.
std::pair<std::unique_ptr<Publisher>, std::unique_ptr<Subscriber>> makeLcmChannel(const LcmOptions& options);

}  // namespace strandcast
