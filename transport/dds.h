#pragma once
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "transport/codec/codec.h"
#include "transport/publisher.h"
#include "transport/subscriber.h"

namespace strandcast {

/// How a reader or a daemon is carried. Any two but kSecure find and understand each other.
enum class DdsProfile {
  kReliableLan,  ///< UDP; what is lost is repaired
  kBestEffort,   ///< UDP; of a reader: frames are not repaired, their lost strands are concealed
  kLocal,  ///< shared memory within a machine, UDP to others. A reader that gets nothing through it goes
           ///< back to UDP
  kSecure  ///< UDP; encrypted, and every program is known and does what it may. These find no others
};
struct DdsProfileInfo {
  DdsProfile profile;
  const char* name;
  const char* help;
};
std::span<const DdsProfileInfo> ddsProfileList();
/// Throws Error, naming `where`, on an unknown name.
DdsProfile ddsProfileNamed(const std::string& name, const std::string& where);

struct DdsOptions {
  int domain = 0;  ///< 0 to 232
  uint32_t groom_id = 1;
  uint64_t session = 0;  ///< publisher only: of this start, not 0
  CodecOptions codec;    ///< publisher only
  /// Publisher only: one of several that share the groom. The strongest of those alive casts; the others take
  /// commands, simulate and stay silent, until within half a second of its end it is their turn.
  std::optional<uint32_t> claim = {};
  DdsProfile profile = DdsProfile::kReliableLan;
  /// IPv4 addresses of machines to look on where multicast does not reach them, beside multicast.
  std::vector<std::string> peers = {};
  /// "ADDRESS:PORT" of a discovery server (`fastdds discovery -i 0 -l ADDRESS -p PORT`), in place of
  /// multicast; empty = none.
  std::string discovery_server = {};
  /// kSecure only: this program's keys and permissions, as checkKeyFolder() accepts them.
  std::filesystem::path keys = {};
  /// Subscriber only. Without, it is given statuses and sends commands, and that is all: for who steers a
  /// daemon and draws nothing. It is no reader to the daemon.
  bool frames = true;
};

/// Whether this build has DDS, and why not.
bool ddsAvailable(std::string* reason = nullptr);

/// Fast DDS over UDPv4, and shared memory with DdsProfile::kLocal. A groom id is a DDS partition ("groom1"),
/// so that a machine receives the frames of the grooms it asked for and no others; statuses go to everyone in
/// the domain. Listening ports: 7400 + 250
/// * domain (UDP multicast 239.255.0.1, discovery) and those following it. Frames of 1 MB or less need
/// net.core.rmem_max >= 4194304 on the reader's machine to survive bursts without repair.
///
/// Both throw Error when an option is out of range or the participant cannot be made: domain out of range, no
/// network interface, a discovery port held by a program that does not share it, keys that are missing, out
/// of force or do not fit. A subscriber whose permissions are to read alone throws Error from send().
std::unique_ptr<Publisher> makeDdsPublisher(const DdsOptions& options);
std::unique_ptr<Subscriber> makeDdsSubscriber(const DdsOptions& options);

}  // namespace strandcast
