// Profiles and discovery of DDS, with daemon and reader in one process or two.
#include <gtest/gtest.h>

#include <arpa/inet.h>
#include <fastrtps/utils/IPLocator.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <sstream>
#include <thread>

#include "dds_domain.h"
#include "peer.h"
#include "sample_messages.h"
#include "tests/expect_error.h"
#include "transport/dds.h"
#include "transport/publisher.h"

namespace strandcast {
namespace {

using std::chrono::milliseconds;

DdsOptions optionsOf(int domain, uint64_t session, DdsProfile profile = DdsProfile::kReliableLan) {
  DdsOptions options;
  options.domain = domain;
  options.session = session;
  options.codec.codec = Codec::kFloat32;
  options.profile = profile;
  return options;
}

/// Number of frames that a reader received of `frames` published at 60 Hz.
uint64_t framesThrough(const DdsOptions& daemon, DdsOptions reader, uint64_t frames = 20) {
  const auto publisher = makeDdsPublisher(daemon);
  GroomDescription groom = uniformGroom(3000, 16);
  groom.session = daemon.session;
  publisher->announce(groom, sampleBody(20));
  reader.session = 0;
  const auto subscriber = makeDdsSubscriber(reader);
  if (!subscriber->waitForGroom(milliseconds(5000))) return 0;
  for (int i = 0; i < 500 && publisher->matchedReaders() == 0; ++i)
    std::this_thread::sleep_for(milliseconds(10));
  for (uint64_t number = 1; number <= frames; ++number) {
    publisher->publish(sampleFrame(groom, number));
    std::this_thread::sleep_for(milliseconds(16));
  }
  std::this_thread::sleep_for(milliseconds(100));
  const auto newest = subscriber->frame();
  EXPECT_TRUE(newest && isSampleFrame(*newest));
  Command command;
  command.id = 5;
  publisher->publishStatus({});
  subscriber->send(command);
  EXPECT_TRUE(publisher->takeCommand());
  return subscriber->statistics().frames_received;
}

TEST(DdsProfiles, AnyTwoUnderstandEachOther) {
  const int domain = testDomain(0);
  using enum DdsProfile;
  EXPECT_EQ(framesThrough(optionsOf(domain, 1, kReliableLan), optionsOf(domain, 0, kBestEffort)), 20u);
  EXPECT_EQ(framesThrough(optionsOf(domain, 2, kLocal), optionsOf(domain, 0, kLocal)), 20u);
  EXPECT_EQ(framesThrough(optionsOf(232, 5, kLocal), optionsOf(232, 0, kLocal)), 20u) << "the last domain";
  EXPECT_EQ(framesThrough(optionsOf(domain, 3, kLocal), optionsOf(domain, 0, kReliableLan)), 20u);
}

TEST(DdsProfiles, ReadersKilledOnSharedMemoryComeBack) {
  const std::string domain = std::to_string(testDomain(1));
  const PeerSetting local("STRANDCAST_PEER_PROFILE", "local");
  Peer publisher({"cast", domain, "60"});
  std::string all;
  for (int round = 0; round < 5; ++round) {
    Peer reader({"read", domain, "60", "0"});
    ASSERT_TRUE(reader.waitFor("first_frame")) << round << reader.text();
    const double ms = reader.results().at("first_frame_after_ms");
    EXPECT_LE(ms, 3000) << "the watchdog goes back to UDP";
    all += ' ';
    all += std::to_string(static_cast<int>(ms));
    reader.kill();
  }
  std::printf("readers on shared memory, each but the first after a killed one: first frame after%s ms\n",
              all.c_str());
}

/// Arguments for a transport_peer that runs as another user; requires root.
std::vector<std::string> asOtherUser(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(),
                   {"--reuid=65534", "--regid=65534", "--clear-groups", STRANDCAST_TRANSPORT_PEER});
  return arguments;
}
const char* const kAsOther = "/usr/bin/setpriv";

TEST(DdsProfiles, SharedMemoryOfAnotherUserIsLeftForUdp) {
  if (geteuid() != 0 || access(kAsOther, X_OK) != 0) GTEST_SKIP() << "takes two users";
  const PeerSetting local("STRANDCAST_PEER_PROFILE", "local");
  const auto expectFrames = [](Peer& reader, const char* who) {
    const Results read = reader.finish();
    ASSERT_TRUE(read.contains("received")) << who << reader.text();
    EXPECT_GE(read.at("received"), 10) << who << reader.text();
    EXPECT_EQ(read.at("wrong"), 0) << who << reader.text();
    EXPECT_NE(reader.text().find("another user"), std::string::npos) << who << reader.text();
  };
  const std::string domain = std::to_string(testDomain(10)), other = std::to_string(testDomain(11));
  Peer daemon({"cast", domain, "60"}), others_daemon(asOtherUser({"cast", other, "60"}), kAsOther);
  Peer others_reader(asOtherUser({"read", domain, "1", "0"}), kAsOther), reader({"read", other, "1", "0"});
  Peer sender(asOtherUser({"send", domain, "101"}), kAsOther);
  expectFrames(others_reader, "another user's reader");
  expectFrames(reader, "a reader of another user's daemon");
  sender.finish();
  EXPECT_EQ(sender.exitCode(), 0) << "a command of another user" << sender.text();
}

TEST(DdsProfiles, NumbersOfOtherProgramsAreLeftToThem) {
  const int domain = testDomain(4);
  constexpr int kFirst = 20, kLast = 114, kFree = 77;  // of participants on shared memory
  const auto portOf = [&](int number) { return firstPort(domain) + 10 + 2 * number; };
  std::vector<int> held;
  const auto hold = [&](int number) {
    held.push_back(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<uint16_t>(portOf(number)));
    return bind(held.back(), reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
  };
  for (int number = kFirst; number <= kLast; ++number) {
    if (number == kFree || number == kFree + 1) continue;
    ASSERT_TRUE(hold(number)) << number;
  }
  const auto publisher = makeDdsPublisher(optionsOf(domain, 1, DdsProfile::kLocal));
  const auto subscriber = makeDdsSubscriber(optionsOf(domain, 0, DdsProfile::kLocal));
  EXPECT_FALSE(hold(kFree));
  EXPECT_FALSE(hold(kFree + 1));
  publisher->announce(uniformGroom(5, 4), sampleBody(3));
  EXPECT_TRUE(subscriber->waitForGroom(milliseconds(5000)));
  for (const int one : held) close(one);
}

TEST(DdsProfiles, ADiscoveryServerBringsThemTogether) {
  namespace dds = eprosima::fastdds::dds;
  namespace rtps = eprosima::fastrtps::rtps;
  const int domain = testDomain(2);
  const auto port = static_cast<uint16_t>(firstPort(domain) + 245);  // participants use ports up to 239
  dds::DomainParticipantQos qos;
  auto& builtin = qos.wire_protocol().builtin;
  builtin.discovery_config.discoveryProtocol = rtps::DiscoveryProtocol_t::SERVER;
  std::istringstream("44.53.00.5f.45.50.52.4f.53.49.4d.41") >> qos.wire_protocol().prefix;
  rtps::Locator_t locator;
  rtps::IPLocator::setIPv4(locator, "127.0.0.1");
  rtps::IPLocator::setPhysicalPort(locator, port);
  builtin.metatrafficUnicastLocatorList.push_back(locator);
  auto* const factory = dds::DomainParticipantFactory::get_instance();
  dds::DomainParticipant* const server =
      factory->create_participant(static_cast<dds::DomainId_t>(domain), qos);
  ASSERT_NE(server, nullptr);
  DdsOptions daemon = optionsOf(domain, 9), reader = optionsOf(domain, 0);
  daemon.discovery_server = reader.discovery_server = "127.0.0.1:" + std::to_string(port);
  EXPECT_EQ(framesThrough(daemon, reader), 20u);
  // Clients of the server are not discovered by multicast, but only through the server.
  const auto publisher = makeDdsPublisher(daemon);
  publisher->announce(uniformGroom(5, 4), sampleBody(3));
  EXPECT_FALSE(makeDdsSubscriber(optionsOf(domain, 0))->waitForGroom(milliseconds(1000)));
  factory->delete_participant(server);
}

TEST(DdsProfiles, BadAddressesAreRefused) {
  for (const char* server :
       {"here", "127.0.0.1", "127.0.0.1:", "127.0.0.1:99999", "host:1234", "127.0.0.1:12x"}) {
    DdsOptions options = optionsOf(testDomain(3), 0);
    options.discovery_server = server;
    EXPECT_NE(errorOf([&] { makeDdsSubscriber(options); }).find(": "), std::string::npos) << server;
  }
  DdsOptions options = optionsOf(testDomain(3), 0);
  options.peers = {"next door"};
  EXPECT_NE(errorOf([&] { makeDdsSubscriber(options); }).find("not an IPv4 address"), std::string::npos);
  options.peers = {"127.0.0.1", "192.0.2.1"};
  EXPECT_NO_THROW(makeDdsSubscriber(options));
  EXPECT_NE(errorOf([] { ddsProfileNamed("fastest", "--profile"); }).find("reliable-lan"), std::string::npos);
}

}  // namespace
}  // namespace strandcast
