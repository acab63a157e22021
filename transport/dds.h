// Public API
#pragma once
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "transport/codec/codec.h"
#include "transport/pose_sender.h"
#include "transport/subscriber.h"

namespace strandcast {

class Publisher;  // transport/publisher.h: the daemon's end, which is not public

/// How a reader or a daemon is carried. All but kSecure are compatible with each other.
enum class DdsProfile {
  kReliableLan,  ///< UDP; lost packets are repaired
  kBestEffort,   ///< UDP; a reader requests no repair of frames and conceals their lost strands
  kLocal,  ///< shared memory within a machine, UDP to others. A reader that receives nothing through it falls
           ///< back to UDP
  kSecure  ///< UDP; encrypted, with certificates and permissions for every program. Compatible only with
           ///< itself
};
/// A profile as the option --profile names and explains it.
struct DdsProfileInfo {
  DdsProfile profile;
  const char* name;
  const char* help;
};
/// All profiles.
std::span<const DdsProfileInfo> ddsProfileList();
/// Throws Error, naming `where`, on an unknown name.
DdsProfile ddsProfileNamed(const std::string& name, const std::string& where);

/// Options of both ends; makeDdsPublisher() and makeDdsSubscriber() check their ranges.
struct DdsOptions {
  int domain = 0;  ///< 0 to 232
  uint32_t groom_id = 1;
  uint64_t session = 0;  ///< publisher only: random per start, not 0
  CodecOptions codec;    ///< publisher only
  /// Publisher only: strength of this daemon's claim, where several share the groom. The strongest live
  /// daemon casts. The others take commands, simulate and send nothing until it ends; within half a second
  /// one of them takes over.
  std::optional<uint32_t> claim = {};
  DdsProfile profile = DdsProfile::kReliableLan;
  /// IPv4 addresses of machines that multicast does not reach, used for discovery beside multicast.
  std::vector<std::string> peers = {};
  /// "ADDRESS:PORT" of a discovery server (`fastdds discovery -i 0 -l ADDRESS -p PORT`) that replaces
  /// multicast; empty = none.
  std::string discovery_server = {};
  /// kSecure only: folder of this program's keys and permissions, as checkKeyFolder() accepts it.
  std::filesystem::path keys = {};
  /// Subscriber only. False: receives statuses and sends commands, and nothing else, for programs that steer
  /// a daemon and draw nothing. The daemon does not count it as a reader.
  bool frames = true;
};

/// Whether this build has DDS; if not, `reason` is set.
bool ddsAvailable(std::string* reason = nullptr);

/// Fast DDS over UDPv4, and shared memory with DdsProfile::kLocal. A groom id is a DDS partition ("groom1"),
/// so that a machine receives the frames of its own grooms only. Statuses go to every participant of the
/// domain. Ports: 7400 + 250 * domain (UDP multicast 239.255.0.1, discovery) and those that follow. Frames of
/// 1 MB or less need net.core.rmem_max >= 4194304 on the reader's machine to survive bursts without repair.
///
/// A sender of poses moves the head and bodies of options.groom_id and of further grooms that one character
/// wears (its beard). A daemon that it has not found yet misses the samples until then. With keys it needs
/// those of a poser or a renderer.
///
/// All throw Error when an option is out of range or the participant cannot be created: no network
/// interface, a discovery port held by a program that does not share it, keys that are missing, not valid now
/// or do not match. A subscriber whose keys permit reading only throws Error from send().
std::unique_ptr<Publisher> makeDdsPublisher(const DdsOptions& options);
std::unique_ptr<Subscriber> makeDdsSubscriber(const DdsOptions& options);
std::unique_ptr<PoseSender> makeDdsPoseSender(const DdsOptions& options,
                                              const std::vector<uint32_t>& further_grooms = {});

}  // namespace strandcast
