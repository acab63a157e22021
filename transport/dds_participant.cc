#include "transport/dds_participant.h"

#include <arpa/inet.h>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastdds/rtps/transport/shared_mem/SharedMemTransportDescriptor.h>
#include <fastrtps/utils/IPLocator.h>
#include <fastrtps/xmlparser/XMLProfileManager.h>
#include <fcntl.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <netinet/in.h>
#include <spdlog/spdlog.h>
#include <sys/file.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/log/Log.hpp>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <string>
#include <string_view>
#include <system_error>

#include "core/error.h"
#include "transport/chunks.h"
#include "transport/security/key_folder.h"

namespace strandcast {
namespace {

// Fast DDS 2.9.1 names ports and segments so. Their user holds the file with the suffix kLock locked during
// its lifetime.
constexpr std::string_view kPort = "fastrtps_port", kSegment = "fastrtps_";
constexpr size_t kSegmentDigits = 16;     // hexadecimal
constexpr int kSegmentStartSeconds = 10;  // within which its program locks a new segment
constexpr const char* kLock = "_el";
constexpr int kFirstPort = 7400, kPortsPerDomain = 250;

bool isPortOf(const std::string& name, int domain) {
  if (!name.starts_with(kPort)) return false;
  int port = 0;
  const char* const end = name.data() + name.size();
  const auto [rest, failure] = std::from_chars(name.data() + kPort.size(), end, port);
  const int first = kFirstPort + kPortsPerDomain * domain;
  return failure == std::errc() && rest == end && port >= first && port < first + kPortsPerDomain;
}

bool isSegment(const std::string& name) {
  return name.size() == kSegment.size() + kSegmentDigits && name.starts_with(kSegment) &&
         name.find_first_not_of("0123456789abcdef", kSegment.size()) == std::string::npos;
}

/// Whether a live program holds the port or segment: one left by a killed program is not locked.
bool isHeld(const std::filesystem::path& held) {
  const int file = open((held.string() + kLock).c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW);
  if (file < 0) return errno != ENOENT;
  const bool is_held = flock(file, LOCK_SH | LOCK_NB) != 0;
  close(file);
  return is_held;
}

}  // namespace

bool anotherUserSharesMemory(int domain, uid_t own, const std::filesystem::path& folder) {
  std::error_code failed;
  for (std::filesystem::directory_iterator i(folder, failed), end; !failed && i != end; i.increment(failed)) {
    struct stat about {};
    if (isPortOf(i->path().filename().string(), domain) && lstat(i->path().c_str(), &about) == 0 &&
        about.st_uid != own && isHeld(i->path()))
      return true;
  }
  return false;
}

size_t removeDeadSegments(uid_t own, const std::filesystem::path& folder) {
  size_t removed = 0;
  std::error_code failed;
  for (std::filesystem::directory_iterator i(folder, failed), end; !failed && i != end; i.increment(failed)) {
    const std::filesystem::path& path = i->path();
    struct stat about {};
    if (!isSegment(path.filename().string()) || lstat(path.c_str(), &about) != 0 || !S_ISREG(about.st_mode) ||
        about.st_uid != own || std::time(nullptr) - about.st_ctime < kSegmentStartSeconds || isHeld(path))
      continue;
    if (unlink(path.c_str()) == 0) ++removed;
    unlink((path.string() + kLock).c_str());
  }
  return removed;
}

namespace dds = eprosima::fastdds::dds;
namespace rtps = eprosima::fastrtps::rtps;

const TopicProfile kGroomTopic{"strandcast/groom", true, 1, kMaxChunks, true, false, true};
const TopicProfile kHairsTopic{"strandcast/hairs", true, 1, kMaxChunks, true, false, true};
const TopicProfile kBodiesTopic{"strandcast/bodies", true, 1, kMaxChunks, true, false, true};
const TopicProfile kCollidersTopic{"strandcast/colliders", true, 1, kMaxChunks, true, false, true};
const TopicProfile kGuidesTopic{"strandcast/guides", false, 4, kMaxChunks, true};
const TopicProfile kPoseTopic{"strandcast/pose", false, 16, 64, true};
const TopicProfile kCommandTopic{"strandcast/command", false, 64, 4, true};
const TopicProfile kStatusTopic{"strandcast/status", true, 1, 1024, false, false, true};
const TopicProfile kClaimTopic{"strandcast/claim", false, 1, 4, true, true};
const TopicProfile kReadersTopic{"strandcast/readers", false, 1, 1024, true};
const TopicProfile kShowTopic{"strandcast/show", false, 1, 2 * kMaxChunks, true};

namespace {

constexpr int kMaxDomain = 232;              // largest whose ports fit 16 bits
constexpr uint32_t kSocketBuffer = 4 << 20;  // bytes; with the default, bursts of a frame are lost
// Numbers of participants; their ports are within the domain's range.
constexpr int kFirstParticipantId = 20, kLastParticipantId = 114;
constexpr int kParticipantIdTries = 8;  // another program may take the number meanwhile
/// Bytes: six of the largest frames that are practical on a network of MTU 1500. With the default of half a
/// megabyte most frames are lost.
constexpr uint32_t kSharedSegment = 64 << 20;
constexpr int kLeaseSeconds = 3;
/// A writer of an exclusive topic loses ownership after this silence.
const eprosima::fastrtps::Duration_t kOwnerDeadline{0, 250000000};
/// Programs per machine that discover each other through 127.0.0.1 when multicast fails.
constexpr uint32_t kLocalPeers = 16;

/// Prints only the first few errors of Fast DDS to standard error, because it repeats them per datagram.
class LimitedErrorLog final : public dds::LogConsumer {
 public:
  void Consume(const dds::Log::Entry& entry) override {
    if (entry.kind != dds::Log::Kind::Error || shown_ == kShown || is_muted) return;
    std::fprintf(stderr, "Fast DDS: %s%s\n", entry.message.c_str(),
                 ++shown_ == kShown ? " (further messages of Fast DDS are not shown)" : "");
  }
  static inline std::atomic<bool> is_muted{false};

 private:
  static constexpr int kShown = 8;
  int shown_ = 0;
};

/// Suppresses errors during its lifetime. Fast DDS logs in its own thread, hence the flushes.
class ScopedLogMute {
 public:
  ScopedLogMute() {
    dds::Log::Flush();
    LimitedErrorLog::is_muted = true;
  }
  ~ScopedLogMute() {
    dds::Log::Flush();
    LimitedErrorLog::is_muted = false;
  }
  ScopedLogMute(const ScopedLogMute&) = delete;
  ScopedLogMute& operator=(const ScopedLogMute&) = delete;
};

/// Sets the process-wide settings of Fast DDS.
void setUpFastDds() {
  static std::once_flag once;
  std::call_once(once, [] {
    // With intra-process delivery, a writer that has lost a reader of its own process (Fast DDS 2.9.1)
    // sometimes sends nothing to later readers and counts samples as acknowledged. Over the network they get
    // everything.
    eprosima::fastrtps::LibrarySettingsAttributes settings;
    settings.intraprocess_delivery = eprosima::fastrtps::INTRAPROCESS_OFF;
    eprosima::fastrtps::xmlparser::XMLProfileManager::library_settings(settings);
    dds::Log::SetVerbosity(dds::Log::Kind::Error);
    dds::Log::ClearConsumers();
    dds::Log::RegisterConsumer(std::make_unique<LimitedErrorLog>());
  });
}

std::string domainName(int domain) { return "DDS domain " + std::to_string(domain); }

uint16_t discoveryPort(int domain) { return static_cast<uint16_t>(7400 + 250 * domain); }

void checkInterfaces(int domain) {
  ifaddrs* first = nullptr;
  if (getifaddrs(&first) != 0) return;  // creating the participant will report it
  bool any = false;
  for (const ifaddrs* i = first; i; i = i->ifa_next) {
    any = any || ((i->ifa_flags & IFF_UP) != 0 && i->ifa_addr && i->ifa_addr->sa_family == AF_INET);
  }
  freeifaddrs(first);
  if (!any) throw Error("no IPv4 network interface is up", domainName(domain), "ip link set lo up");
}

/// 0, or the errno with which binding this UDP port fails. With `shared`, programs that share the port may
/// hold it.
int bindErrorOf(int port, bool shared) {
  const int probe = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (probe < 0) return errno;
  const int on = shared ? 1 : 0;
  setsockopt(probe, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<uint16_t>(port));
  address.sin_addr.s_addr = htonl(INADDR_ANY);
  const int result = bind(probe, reinterpret_cast<const sockaddr*>(&address), sizeof address);
  const int cause = result == 0 ? 0 : errno;
  close(probe);
  return cause;
}

/// Fast DDS binds this port shared (SO_REUSEADDR). When that fails, it continues without being discoverable.
void checkDiscoveryPort(int domain) {
  const int cause = bindErrorOf(discoveryPort(domain), true);
  if (cause == 0) return;
  const std::string port = "UDP port " + std::to_string(discoveryPort(domain));
  if (cause == EADDRINUSE) {
    throw Error(port + " is in use by a program that does not share it", domainName(domain),
                "choose another --domain or end that program");
  }
  throw Error(port + " cannot be opened: " + std::strerror(cause), domainName(domain),
              "choose another --domain");
}

rtps::Locator_t locatorOf(const std::string& address, uint32_t port) {
  rtps::Locator_t locator;
  if (!rtps::IPLocator::setIPv4(locator, address))
    throw Error("not an IPv4 address", address, "give it as 192.168.1.20");
  rtps::IPLocator::setPhysicalPort(locator, static_cast<uint16_t>(port));
  return locator;
}

rtps::Locator_t serverLocator(const std::string& text) {
  const size_t colon = text.find(':');
  uint32_t port = 0;
  if (colon != std::string::npos) {
    const char* const end = text.data() + text.size();
    const auto [rest, failure] = std::from_chars(text.data() + colon + 1, end, port);
    if (rest != end || failure != std::errc() || port > 65535) port = 0;
  }
  if (port == 0) throw Error("not a discovery server", text, "give it as 192.168.1.20:11811");
  return locatorOf(text.substr(0, colon), port);
}

/// Largest number whose ports exist; Fast DDS ends the process for ports beyond.
int lastParticipantId(int domain) {
  return std::min(kLastParticipantId, (65535 - 11 - discoveryPort(domain)) / 2);
}

/// After a participant was killed, the shared-memory ports of its number accept nothing for seconds.
/// Consecutive programs therefore use different numbers. Concurrent programs do too, as their UDP ports show:
/// Fast DDS detects a number in use only within the process.
int32_t unusedParticipantId(int domain) {
  static std::atomic<int> made{0};
  const int numbers = lastParticipantId(domain) - kFirstParticipantId + 1;
  int32_t id = 0;
  for (int tries = 0; tries < numbers; ++tries) {
    id = kFirstParticipantId + (getpid() + made++) % numbers;
    const int port = discoveryPort(domain) + 10 + 2 * id;
    if (bindErrorOf(port, false) == 0 && bindErrorOf(port + 1, false) == 0) break;
  }
  return id;
}

/// OMG DDS Security 1.1 with its built-in plugins: PKI-DH, Access-Permissions, AES-GCM-GMAC.
void secure(const std::filesystem::path& keys, eprosima::fastrtps::rtps::PropertyPolicy& policy) {
  const auto set = [&](const char* name, const std::string& value) {
    policy.properties().emplace_back(std::string("dds.sec.") + name, value);
  };
  const auto file = [&](const char* name) {
    return "file://" + (std::filesystem::absolute(keys) / name).string();
  };
  set("auth.plugin", "builtin.PKI-DH");
  set("auth.builtin.PKI-DH.identity_ca", file(kIdentityCa));
  set("auth.builtin.PKI-DH.identity_certificate", file(kCertificate));
  set("auth.builtin.PKI-DH.private_key", file(kPrivateKey));
  set("access.plugin", "builtin.Access-Permissions");
  set("access.builtin.Access-Permissions.permissions_ca", file(kPermissionsCa));
  set("access.builtin.Access-Permissions.governance", file(kGovernance));
  set("access.builtin.Access-Permissions.permissions", file(kPermissions));
  set("crypto.plugin", "builtin.AES-GCM-GMAC");
}

dds::DomainParticipantQos participantQos(const DdsNetwork& network) {
  const int domain = network.domain;
  dds::DomainParticipantQos qos;
  qos.name("strandcast");
  auto udp = std::make_shared<eprosima::fastdds::rtps::UDPv4TransportDescriptor>();
  udp->sendBufferSize = kSocketBuffer;
  udp->receiveBufferSize = kSocketBuffer;
  udp->maxInitialPeersRange = kLocalPeers;
  qos.transport().use_builtin_transports = false;
  qos.transport().user_transports.push_back(udp);
  if (network.uses_shared_memory) {
    auto memory = std::make_shared<eprosima::fastdds::rtps::SharedMemTransportDescriptor>();
    memory->segment_size(kSharedSegment);
    qos.transport().user_transports.push_back(memory);
    udp->maxInitialPeersRange = static_cast<uint32_t>(lastParticipantId(domain) + 1);
    qos.wire_protocol().participant_id = unusedParticipantId(domain);
  }

  if (!network.keys.empty()) secure(network.keys, qos.properties());

  auto& builtin = qos.wire_protocol().builtin;
  auto& discovery = builtin.discovery_config;
  discovery.leaseDuration = {kLeaseSeconds, 0};
  // Short, so that a participant whose first announcements are lost is discovered soon
  discovery.leaseDuration_announcementperiod = {0, 250000000};
  discovery.initial_announcements.count = 10;
  discovery.initial_announcements.period = {0, 100000000};
  if (!network.discovery_server.empty()) {
    discovery.discoveryProtocol = rtps::DiscoveryProtocol_t::CLIENT;
    rtps::RemoteServerAttributes server;
    server.ReadguidPrefix("44.53.00.5f.45.50.52.4f.53.49.4d.41");  // server 0 of the fastdds tool
    server.metatrafficUnicastLocatorList.push_back(serverLocator(network.discovery_server));
    discovery.m_DiscoveryServers.push_back(server);
    return qos;
  }
  // Multicast as by default, and this machine by address: programs of one machine discover each other on any
  // network.
  rtps::Locator_t multicast, local;
  rtps::IPLocator::setIPv4(multicast, "239.255.0.1");
  rtps::IPLocator::setPhysicalPort(multicast, discoveryPort(domain));
  rtps::IPLocator::setIPv4(local, "127.0.0.1");
  builtin.initialPeersList.push_back(multicast);
  builtin.initialPeersList.push_back(local);
  for (const std::string& peer : network.peers) builtin.initialPeersList.push_back(locatorOf(peer, 0));
  return qos;
}

void setLimits(dds::ResourceLimitsQosPolicy& limits, const TopicProfile& profile) {
  limits.max_instances = profile.max_instances;
  limits.max_samples_per_instance = profile.depth;
  limits.max_samples = profile.max_instances * profile.depth;
  limits.allocated_samples = 16;
}

template <class Qos>
void setCommon(Qos& qos, const TopicProfile& profile) {
  qos.reliability().kind = dds::RELIABLE_RELIABILITY_QOS;
  qos.durability().kind =
      profile.is_transient_local ? dds::TRANSIENT_LOCAL_DURABILITY_QOS : dds::VOLATILE_DURABILITY_QOS;
  qos.history().kind = dds::KEEP_LAST_HISTORY_QOS;  // never keep all: one slow reader would stall the writer
  qos.history().depth = profile.depth;
  setLimits(qos.resource_limits(), profile);
  if (profile.is_exclusive) {
    qos.ownership().kind = dds::EXCLUSIVE_OWNERSHIP_QOS;
    // Not by liveliness: Fast DDS 2.9.1 reports its loss only when the whole participant's lease has expired.
    qos.deadline().period = kOwnerDeadline;
  }
  qos.data_sharing().off();
  qos.endpoint().history_memory_policy = rtps::DYNAMIC_REUSABLE_MEMORY_MODE;
}

}  // namespace

DdsNetwork::DdsNetwork(const DdsOptions& options)
    : domain(options.domain),
      uses_shared_memory(options.profile == DdsProfile::kLocal),
      peers(options.peers),
      discovery_server(options.discovery_server),
      keys(options.keys) {
  const bool is_secure = options.profile == DdsProfile::kSecure;
  if (is_secure && keys.empty()) {
    throw Error("the profile needs keys", "--profile secure",
                "give --keys KEYS/daemon or KEYS/renderer; `strandcast keys KEYS` makes some for tests");
  }
  if (!is_secure && !keys.empty())
    throw Error("keys are used by one profile alone", "--keys", "give --profile secure too");
  if (is_secure && !discovery_server.empty()) {
    throw Error("a discovery server has no keys", "--profile secure with --discovery-server",
                "give the addresses of the other machines by --peers");
  }
  if (uses_shared_memory && options.frames && anotherUserSharesMemory(domain, geteuid())) {
    spdlog::info("a program of another user is on the shared memory of DDS domain {}: going over UDP",
                 domain);
    uses_shared_memory = false;
  }
  if (!uses_shared_memory) return;
  if (const size_t dead = removeDeadSegments(geteuid()); dead > 0)
    spdlog::info("{} segments of shared memory of killed programs removed", dead);
}

DdsParticipant::DdsParticipant(const DdsNetwork& network, uint32_t groom_id,
                               const std::optional<DdsRole>& role, DdsNeighbours* neighbours,
                               const std::vector<uint32_t>& further_grooms)
    : domain_(network.domain), keys_(network.keys) {
  const int domain = network.domain;
  if (domain < 0 || domain > kMaxDomain) {
    throw Error("the DDS domain is out of range", std::to_string(domain), "choose 0 to 232");
  }
  setUpFastDds();
  if (!keys_.empty()) checkKeyFolder(keys_);
  checkInterfaces(domain);
  checkDiscoveryPort(domain);
  for (int tries = network.uses_shared_memory ? kParticipantIdTries : 1; !participant_ && tries > 0;
       --tries) {
    dds::DomainParticipantQos qos = participantQos(network);
    if (role && keys_.empty()) qos.user_data().setValue(userDataOf(*role));
    participant_ = dds::DomainParticipantFactory::get_instance()->create_participant(
        static_cast<dds::DomainId_t>(domain), qos, neighbours, dds::StatusMask::none());
  }
  if (!participant_) fail("no DDS participant can be made");
  const auto partition = [](uint32_t of) { return "groom" + std::to_string(of); };
  dds::PublisherQos publisher_qos;
  dds::SubscriberQos subscriber_qos;
  common_publisher_ = participant_->create_publisher(publisher_qos);
  common_subscriber_ = participant_->create_subscriber(subscriber_qos);
  publisher_qos.partition().push_back(partition(groom_id).c_str());
  for (const uint32_t further : further_grooms)
    publisher_qos.partition().push_back(partition(further).c_str());
  subscriber_qos.partition().push_back(partition(groom_id).c_str());
  groom_publisher_ = participant_->create_publisher(publisher_qos);
  groom_subscriber_ = participant_->create_subscriber(subscriber_qos);
  if (!common_publisher_ || !common_subscriber_ || !groom_publisher_ || !groom_subscriber_) {
    fail("no DDS publisher or subscriber can be made");
  }
}

DdsParticipant::~DdsParticipant() {
  if (!participant_) return;
  participant_->delete_contained_entities();
  dds::DomainParticipantFactory::get_instance()->delete_participant(participant_);
}

void DdsParticipant::fail(const std::string& what) {
  // The destructor of an object under construction does not run.
  if (participant_) {
    participant_->delete_contained_entities();
    dds::DomainParticipantFactory::get_instance()->delete_participant(participant_);
    participant_ = nullptr;
  }
  if (!keys_.empty()) {
    throw Error(
        what + " with these keys", keys_.string(),
        "see the messages of Fast DDS above: are permissions.p7s for the subject of cert.pem, this domain "
        "and this groom, and for what this program does?");
  }
  throw Error(what, domainName(domain_), "see the messages of Fast DDS above, or choose another --domain");
}

dds::Topic* DdsParticipant::topic(const TopicProfile& profile, dds::TopicDataType* raw_type) {
  const dds::TypeSupport type(raw_type);  // takes ownership
  if (dds::TopicDescription* known = participant_->lookup_topicdescription(profile.name)) {
    return static_cast<dds::Topic*>(known);
  }
  // Other implementations reject the type objects that Fast DDS 2.9 announces.
  raw_type->auto_fill_type_object(false);
  raw_type->auto_fill_type_information(false);
  type.register_type(participant_);
  dds::Topic* topic = participant_->create_topic(profile.name, type.get_type_name(), dds::TOPIC_QOS_DEFAULT);
  if (!topic) fail(std::string("no topic ") + profile.name + " can be made");
  return topic;
}

dds::DataWriter* DdsParticipant::createWriter(const TopicProfile& profile, dds::TopicDataType* type,
                                              dds::DataWriterListener* listener, uint32_t strength) {
  dds::DataWriter* const writer = makeWriter(profile, type, listener, strength);
  if (!writer) fail(std::string("no writer of ") + profile.name + " can be made");
  return writer;
}

dds::DataWriter* DdsParticipant::makeWriter(const TopicProfile& profile, dds::TopicDataType* type,
                                            dds::DataWriterListener* listener, uint32_t strength) {
  dds::DataWriterQos qos;
  setCommon(qos, profile);
  if (profile.is_exclusive) qos.ownership_strength().value = strength;
  // Also for topics whose readers are volatile, which get no history either way. A volatile writer deletes
  // samples when a reader leaves. In Fast DDS 2.9.1 that deadlocks with the thread that repairs another
  // reader (StatefulWriter::matched_reader_remove against FlowControllerImpl::run), and the daemon hangs.
  qos.durability().kind = dds::TRANSIENT_LOCAL_DURABILITY_QOS;
  // In asynchronous mode samples would be replaced before they are sent.
  qos.publish_mode().kind = dds::SYNCHRONOUS_PUBLISH_MODE;
  auto& times = qos.reliable_writer_qos().times;
  times.heartbeatPeriod = {0, 20000000};
  times.nackResponseDelay = {0, 0};
  times.nackSupressionDuration = {0, 0};
  dds::Publisher* publisher = profile.is_per_groom ? groom_publisher_ : common_publisher_;
  return publisher->create_datawriter(topic(profile, type), qos, listener,
                                      dds::StatusMask::publication_matched());
}

dds::DataWriter* DdsParticipant::createWriterIfPermitted(const TopicProfile& profile,
                                                         dds::TopicDataType* type,
                                                         dds::DataWriterListener* listener) {
  if (keys_.empty()) return createWriter(profile, type, listener);
  const ScopedLogMute silence;  // a missing permission is no error here, but Fast DDS logs several
  return makeWriter(profile, type, listener, 0);
}

dds::DataReader* DdsParticipant::createReader(const TopicProfile& profile, dds::TopicDataType* type,
                                              dds::DataReaderListener* listener, bool is_reliable) {
  dds::DataReader* const reader = makeReader(profile, type, listener, is_reliable);
  if (!reader) fail(std::string("no reader of ") + profile.name + " can be made");
  return reader;
}

dds::DataReader* DdsParticipant::createReaderIfPermitted(const TopicProfile& profile,
                                                         dds::TopicDataType* type,
                                                         dds::DataReaderListener* listener) {
  if (keys_.empty()) return createReader(profile, type, listener);
  const ScopedLogMute silence;  // as in createWriterIfPermitted()
  return makeReader(profile, type, listener, true);
}

dds::DataReader* DdsParticipant::makeReader(const TopicProfile& profile, dds::TopicDataType* type,
                                            dds::DataReaderListener* listener, bool is_reliable) {
  dds::DataReaderQos qos;
  setCommon(qos, profile);
  if (!is_reliable) qos.reliability().kind = dds::BEST_EFFORT_RELIABILITY_QOS;
  qos.reliable_reader_qos().times.heartbeatResponseDelay = {0, 0};
  // With memory preallocated to the sample's size, a reader of Fast DDS 2.9.1 refuses disposals, which have
  // no payload, and then gets no later samples either.
  if (profile.is_withdrawn)
    qos.endpoint().history_memory_policy = rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
  dds::Subscriber* subscriber = profile.is_per_groom ? groom_subscriber_ : common_subscriber_;
  return subscriber->create_datareader(topic(profile, type), qos, listener,
                                       dds::StatusMask::data_available()
                                           << dds::StatusMask::subscription_matched());
}

}  // namespace strandcast
