#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <random>
#include <thread>

#include "dds_domain.h"
#include "sample_messages.h"
#include "transport/dds.h"
#include "transport/dds_participant.h"
#include "transport/dds_type.h"
#include "true_within.h"

namespace strandcast {
namespace {

using eprosima::fastrtps::rtps::InstanceHandle_t;
using eprosima::fastrtps::rtps::SerializedPayload_t;

/// A type with the name of one of ours that sends arbitrary bytes.
class RawType final : public eprosima::fastdds::dds::TopicDataType {
 public:
  explicit RawType(const char* name) {
    setName(name);
    m_typeSize = 2048;
    m_isGetKeyDefined = true;
  }
  bool serialize(void* data, SerializedPayload_t* payload) override {
    const auto& bytes = *static_cast<std::vector<uint8_t>*>(data);
    std::memcpy(payload->data, bytes.data(), bytes.size());
    payload->length = static_cast<uint32_t>(bytes.size());
    return true;
  }
  bool deserialize(SerializedPayload_t*, void*) override { return false; }
  std::function<uint32_t()> getSerializedSizeProvider(void* data) override {
    return [data] { return static_cast<uint32_t>(static_cast<std::vector<uint8_t>*>(data)->size()); };
  }
  void* createData() override { return new std::vector<uint8_t>; }
  void deleteData(void* data) override { delete static_cast<std::vector<uint8_t>*>(data); }
  bool getKey(void* data, InstanceHandle_t* handle, bool) override {
    handle->value[0] = (*static_cast<std::vector<uint8_t>*>(data))[0] % 4;
    return true;
  }
};

bool isMatched(const MatchCounter& match) {
  return trueWithin(std::chrono::seconds(5), [&] { return match.matched() > 0; });
}

TEST(RogueWriter, BadSamplesOnEveryTopicDoNoHarm) {
  const int domain = testDomain(7);
  const auto publisher = makeDdsPublisher({domain, 1, 11, {Codec::kFloat32}});
  const auto subscriber = makeDdsSubscriber({domain, 1, 0, {}});
  const GroomDescription groom = uniformGroom(1500, 10);
  publisher->announce(groom, sampleBody(20));
  ASSERT_TRUE(subscriber->waitForGroom(std::chrono::milliseconds(5000)));

  DdsParticipant rogue(DdsNetwork(domain), 1);
  MatchCounter matches[5];
  eprosima::fastdds::dds::DataWriter* writers[] = {
      rogue.createWriter(kGroomTopic, new RawType(WireType<GroomChunk>().getName()), &matches[0]),
      rogue.createWriter(kBodiesTopic, new RawType(WireType<BodyChunk>().getName()), &matches[1]),
      rogue.createWriter(kGuidesTopic, new RawType(WireType<GuideChunk>().getName()), &matches[2]),
      rogue.createWriter(kCommandTopic, new RawType(WireType<Command>().getName()), &matches[3]),
      rogue.createWriter(kStatusTopic, new RawType(WireType<Status>().getName()), &matches[4])};
  for (const MatchCounter& match : matches) ASSERT_TRUE(isMatched(match));
  std::mt19937 random(9);
  for (int i = 0; i < 400; ++i) {
    std::vector<uint8_t> bytes(1 + random() % 1500);
    for (uint8_t& byte : bytes) byte = static_cast<uint8_t>(random() % 3 == 0 ? random() : 0);
    // Half of them begin with a valid little-endian CDR header, so that the fields are reached.
    const uint8_t head[] = {0, 1, 0, 0};
    if (i % 2 != 0 && bytes.size() >= sizeof head) std::memcpy(bytes.data(), head, sizeof head);
    for (auto* writer : writers) writer->write(&bytes);
  }
  for (auto* writer : writers) writer->wait_for_acknowledgments({2, 0});

  EXPECT_FALSE(publisher->takeCommand());
  EXPECT_EQ(subscriber->groom()->guides.strands(), 1500u);
  for (uint64_t number = 1; number <= 20; ++number) {
    publisher->publish(sampleFrame(groom, number));
    const auto frame = subscriber->waitForFrame(number - 1, std::chrono::milliseconds(2000));
    ASSERT_TRUE(frame) << number;
    EXPECT_TRUE(isSampleFrame(*frame));
  }
  EXPECT_EQ(subscriber->statistics().frames_lost, 0u);
}

TEST(Readers, AReaderThatLacksTheGroomForLongGetsItAgain) {
  const int domain = testDomain(21);
  const auto publisher = makeDdsPublisher({domain, 1, 11, {Codec::kFloat32}});
  const GroomDescription groom = uniformGroom(100, 10);
  publisher->announce(groom, sampleBody(20));
  const size_t body_chunks = splitBody(sampleBody(20)).size();
  std::atomic<size_t> grooms{0}, bodies{0};
  SampleListener<GroomChunk> groom_listener([&](GroomChunk&, const auto&) { ++grooms; });
  SampleListener<BodyChunk> body_listener([&](BodyChunk&, const auto&) { ++bodies; });
  DdsParticipant reader(DdsNetwork(domain), 1);
  reader.createReader(kGroomTopic, new WireType<GroomChunk>, &groom_listener);
  reader.createReader(kBodiesTopic, new WireType<BodyChunk>, &body_listener);
  ASSERT_TRUE(trueWithin(std::chrono::seconds(5), [&] { return grooms == 1 && bodies == body_chunks; }));
  MatchCounter daemons;
  auto* const writer = reader.createWriter(kReadersTopic, new WireType<ReaderReport>, &daemons);
  ASSERT_TRUE(isMatched(daemons));
  ReaderReport report;
  report.reader = 5;
  report.groom_id = 1;
  report.pixels = 320;
  report.wants = ReaderReport::kGroomAndBody;
  uint64_t frame = 0;
  const auto isRepeated = [&] {
    writer->write(&report);
    publisher->publish(sampleFrame(groom, ++frame));
    return grooms > 1 && bodies > body_chunks;
  };
  EXPECT_TRUE(trueWithin(std::chrono::seconds(5), isRepeated));
  EXPECT_EQ(publisher->readers().largest_pixels, 320);
}

TEST(Readers, TellTheSizeOfTheirPictures) {
  const int domain = testDomain(22);
  const auto publisher = makeDdsPublisher({domain, 1, 11, {Codec::kFloat32}});
  const auto subscriber = makeDdsSubscriber({domain, 1, 0, {}});
  EXPECT_EQ(publisher->readers().largest_pixels, -1);
  const auto becomes = [&](float pixels) {
    return trueWithin(std::chrono::seconds(5), [&] { return publisher->readers().largest_pixels == pixels; });
  };
  for (const float pixels : {640.0f, 0.0f, 12.0f, -1.0f}) {
    subscriber->setPictures(pixels, 60);
    EXPECT_TRUE(becomes(pixels)) << pixels;
  }
}

TEST(Claims, AStatusThatComesBeforeItsClaimIsNoRivals) {
  const int domain = testDomain(8);
  const auto publisher = makeDdsPublisher({domain, 1, 11, {Codec::kFloat32}, 1});
  std::this_thread::sleep_for(std::chrono::milliseconds(2700));  // until it knows whether another one casts
  const auto speak = [](DdsParticipant& participant, uint64_t session, MatchCounter& match) {
    auto* const writer = participant.createWriter(kStatusTopic, new WireType<Status>, &match);
    Status status;
    status.groom_id = 1;
    status.session = session;
    status.strands = 10;
    writer->write(&status);
    return isMatched(match);
  };
  DdsParticipant sharer(DdsNetwork(domain), 1), stranger(DdsNetwork(domain), 1);
  MatchCounter sharers, strangers;
  ASSERT_TRUE(speak(sharer, 22, sharers));
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  EXPECT_FALSE(publisher->conflict()) << "its claim may come";
  sharer.createWriter(kClaimTopic, new WireType<Claim>, nullptr, 2);
  ASSERT_TRUE(speak(stranger, 33, strangers));
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(10);
  while (!publisher->conflict() && std::chrono::steady_clock::now() < end)
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  EXPECT_EQ(publisher->conflict(), (ConflictingDaemon{33, true})) << "who claims nothing shares nothing";
}

TEST(Neighbours, ARoleIsReadAsItWasSaid) {
  for (const DdsRole& role :
       {DdsRole{true, 1, false}, DdsRole{true, 4294967295u, true}, DdsRole{false, 7, false}})
    EXPECT_EQ(roleOf(userDataOf(role)), role);
  const auto read = [](const std::string& text) {
    return roleOf(std::span(reinterpret_cast<const uint8_t*>(text.data()), text.size())).has_value();
  };
  EXPECT_TRUE(read("strandcast;daemon;7;claim"));
  for (const char* const none :
       {"", "strandcast", "strandcast;", "strandcast;daemon;", "strandcast;daemon;x", "strandcast;daemon;7x",
        "strandcast;daemon;4294967296", "strandcast;king;7", "strandcast;reader;7;claim", "other;daemon;7"})
    EXPECT_FALSE(read(none)) << none;
}

TEST(Neighbours, ADaemonOnSharedMemoryWaitsForOneThatIsThereAndIsNotHeard) {
  const int domain = testDomain(18);
  DdsOptions options{domain, 1, 11, {Codec::kFloat32}, 1};
  options.profile = DdsProfile::kLocal;
  const auto publisher = makeDdsPublisher(options);
  const auto becomes = [&](bool waits) {
    return trueWithin(std::chrono::seconds(5),
                      [&] { return (publisher->listenTime() > kConflictListenTime) == waits; });
  };
  EXPECT_TRUE(becomes(false));
  const DdsParticipant reader(DdsNetwork(domain), 1, DdsRole{false, 1, false});
  const DdsParticipant of_another_groom(DdsNetwork(domain), 2, DdsRole{true, 2, true});
  DdsParticipant silent(DdsNetwork(domain), 1, DdsRole{true, 1, true});
  EXPECT_TRUE(becomes(true));
  EXPECT_FALSE(publisher->hasUnreachableDaemonOfGroom()) << "its writers may yet be found";
  silent.createWriter(kClaimTopic, new WireType<Claim>, nullptr, 7);
  EXPECT_TRUE(becomes(false));
}

TEST(SharedMemoryUsers, AreThoseThatHoldAPortOfTheDomain) {
  std::string name = (std::filesystem::temp_directory_path() / "strandcast-shm-XXXXXX").string();
  ASSERT_NE(mkdtemp(name.data()), nullptr);
  const std::filesystem::path folder = name;
  const uid_t own = geteuid(), other = own + 1;
  const auto isShared = [&](int domain, uid_t by) { return anotherUserSharesMemory(domain, by, folder); };
  EXPECT_FALSE(anotherUserSharesMemory(3, other, folder / "absent"));
  for (const char* const file : {"fastrtps_port8160", "sem.fastrtps_port8161_mutex", "fastrtps_0123abcd"})
    std::ofstream(folder / file) << 'x';
  EXPECT_FALSE(isShared(3, other)) << "nobody holds it";
  const std::string lock = (folder / "fastrtps_port8160_el").string();
  const int held = open(lock.c_str(), O_CREAT | O_RDWR | O_CLOEXEC, 0644);
  EXPECT_FALSE(isShared(3, other)) << "left behind by a program that was killed";
  ASSERT_EQ(flock(held, LOCK_EX), 0);
  EXPECT_TRUE(isShared(3, other));
  EXPECT_FALSE(isShared(3, own)) << "its own";
  EXPECT_FALSE(isShared(2, other)) << "of another domain";
  EXPECT_FALSE(isShared(4, other));
  close(held);
  EXPECT_FALSE(isShared(3, other));
  std::filesystem::remove_all(folder);
}

TEST(DeadSegments, AreRemovedWhereNoProgramHoldsThem) {
  std::string name = (std::filesystem::temp_directory_path() / "strandcast-shm-XXXXXX").string();
  ASSERT_NE(mkdtemp(name.data()), nullptr);
  const std::filesystem::path folder = name, dead = folder / "fastrtps_0123456789abcdef",
                              live = folder / "fastrtps_fedcba9876543210",
                              port = folder / "fastrtps_port8160",
                              foreign = folder / "fastrtps_0123456789abcdeg";
  for (const auto& file : {dead, live, port, foreign}) {
    std::ofstream(file) << 'x';
    std::ofstream(file.string() + "_el") << "";
  }
  EXPECT_EQ(removeDeadSegments(geteuid(), folder), 0u) << "new ones may not be locked yet";
  const int held = open((live.string() + "_el").c_str(), O_RDWR | O_CLOEXEC);
  ASSERT_EQ(flock(held, LOCK_EX), 0);
  std::this_thread::sleep_for(std::chrono::seconds(11));
  EXPECT_EQ(removeDeadSegments(geteuid() + 1, folder), 0u) << "of another user";
  EXPECT_EQ(removeDeadSegments(geteuid(), folder / "absent"), 0u);
  EXPECT_EQ(removeDeadSegments(geteuid(), folder), 1u);
  EXPECT_FALSE(std::filesystem::exists(dead));
  EXPECT_FALSE(std::filesystem::exists(dead.string() + "_el"));
  for (const auto& file : {live, port, foreign}) EXPECT_TRUE(std::filesystem::exists(file)) << file;
  close(held);
  std::filesystem::remove_all(folder);
}

TEST(Neighbours, TheStrengthOfAClaimIsKnown) {
  const int domain = testDomain(19);
  DdsNeighbours neighbours;
  const DdsParticipant own(DdsNetwork(domain), 1, DdsRole{true, 1, true}, &neighbours);
  DdsParticipant other(DdsNetwork(domain), 1, DdsRole{true, 1, true});
  other.createWriter(kStatusTopic, new WireType<Status>, nullptr);
  other.createWriter(kClaimTopic, new WireType<Claim>, nullptr, 4000000000u);
  const auto strength = [&]() -> std::optional<uint32_t> {
    for (const auto& [prefix, since] : neighbours.claimants(1))
      if (const auto known = neighbours.strengthOf(prefix)) return known;
    return std::nullopt;
  };
  EXPECT_TRUE(trueWithin(std::chrono::seconds(5), [&] { return strength() == 4000000000u; }));
  EXPECT_FALSE(neighbours.hasDaemonWithoutWriters(1, std::chrono::milliseconds(0)));
}

TEST(Neighbours, ProgramsOfAnotherVersionAreNamedAndAreNoRivals) {
  const int domain = testDomain(20);
  const auto publisher = makeDdsPublisher({domain, 1, 11, {Codec::kFloat32}});
  const auto subscriber = makeDdsSubscriber({domain, 1, 0, {}});
  const auto becomesTrue = [](const auto& condition) {
    return trueWithin(std::chrono::seconds(5), condition);
  };
  DdsParticipant daemon(DdsNetwork(domain), 1, DdsRole{true, 1, false}),
      of_another_groom(DdsNetwork(domain), 2, DdsRole{true, 2, false}),
      reader(DdsNetwork(domain), 1, DdsRole{false, 1, false});
  of_another_groom.createWriter(kGuidesTopic, new RawType("strandcast::v5::GuideChunk"), nullptr);
  EXPECT_TRUE(becomesTrue([&] { return publisher->possibleConflicts() == 1; }));
  EXPECT_FALSE(subscriber->otherVersion() || publisher->otherVersion());
  daemon.createWriter(kGuidesTopic, new RawType("strandcast::v6::GuideChunk"), nullptr);
  reader.createReader(kGuidesTopic, new RawType("strandcast::v8::GuideChunk"), nullptr);
  EXPECT_TRUE(becomesTrue([&] { return subscriber->otherVersion() == OtherVersion{true, 6, 6}; }));
  EXPECT_TRUE(becomesTrue([&] { return publisher->otherVersion() == OtherVersion{false, 0, 0}; }));
  EXPECT_TRUE(becomesTrue([&] { return publisher->possibleConflicts() == 0; }));
}

TEST(Neighbours, ADaemonListensForLongOnlyWhereARivalMayBe) {
  const int domain = testDomain(9);
  const auto publisher = makeDdsPublisher({domain, 1, 11, {Codec::kFloat32}});
  EXPECT_EQ(publisher->listenTime(), kShortListenTime);
  const auto becomes = [&](size_t conflicts) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(5);
    while (publisher->possibleConflicts() != conflicts && std::chrono::steady_clock::now() < end)
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    return publisher->possibleConflicts() == conflicts;
  };
  {
    // When the last one is discovered, the others are known too, and count by their roles.
    const DdsParticipant reader(DdsNetwork(domain), 1, DdsRole{false, 1, false});
    const DdsParticipant of_another_groom(DdsNetwork(domain), 2, DdsRole{true, 2, false});
    const DdsParticipant says_nothing(DdsNetwork(domain), 1);
    EXPECT_TRUE(becomes(1));
    EXPECT_EQ(publisher->listenTime(), kConflictListenTime);
  }
  EXPECT_TRUE(becomes(0)) << "those that leave are forgotten";
  const DdsParticipant conflict(DdsNetwork(domain), 1, DdsRole{true, 1, true});
  EXPECT_TRUE(becomes(1));
  EXPECT_EQ(publisher->listenTime(), kConflictListenTime);
}

}  // namespace
}  // namespace strandcast
