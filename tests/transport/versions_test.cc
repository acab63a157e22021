#include "transport/versions.h"

#include <gtest/gtest.h>

#include <chrono>

#include "lossy_link.h"
#include "transport/lcm/lcm_ends.h"
#include "transport/lcm/lcm_messages.h"
#include "transport/publisher.h"
#include "transport/subscriber.h"
#include "true_within.h"

namespace strandcast {
namespace {

/// A message of that fingerprint, as long as the longest head that is read of one; groom_id of a status is 7.
std::vector<uint8_t> messageOf(uint64_t fingerprint) {
  std::vector<uint8_t> bytes(200);
  storeBigEndian(fingerprint, bytes.data());
  storeBigEndian(uint32_t{7}, bytes.data() + 144);
  return bytes;
}
constexpr uint64_t kStatus6 = 0xef3e4cb5aa11d6fb, kGuides6 = 0x161dfb4605380567,
                   kReader6 = 0x5d852f45c87b1138;

TEST(Versions, ATypeOfDdsNamesItsVersion) {
  EXPECT_EQ(versionOfType("strandcast::v6::GuideChunk"), 6);
  EXPECT_EQ(versionOfType("strandcast::v7::Status"), 7);
  EXPECT_EQ(versionOfType("strandcast::v12::Status"), 12);
  for (const char* const none : {"", "strandcast", "strandcast::v", "strandcast::v6", "strandcast::vx::A",
                                 "strandcast::v0::A", "strandcast::v-6::A", "other::v6::A"})
    EXPECT_EQ(versionOfType(none), 0) << none;
}

TEST(Versions, AFingerprintOfLcmNamesItsVersions) {
  const auto version = [](uint64_t fingerprint) { return versionOfMessage(messageOf(fingerprint), true); };
  EXPECT_EQ(version(kGuides6), (OtherVersion{true, 6, 6}));
  EXPECT_EQ(version(kStatus6), (OtherVersion{true, 5, 6}));
  EXPECT_EQ(version(12345), (OtherVersion{true, 0, 0})) << "a newer one";
  EXPECT_EQ(version(lcmFingerprint<GuideChunk>()), std::nullopt);
  EXPECT_EQ(version(lcmFingerprint<Status>()), std::nullopt);
  EXPECT_EQ(versionOfMessage({}, true), std::nullopt);
  EXPECT_TRUE(isOldStatusOf(7, messageOf(kStatus6)));
  EXPECT_FALSE(isOldStatusOf(8, messageOf(kStatus6)));
  EXPECT_FALSE(isOldStatusOf(7, messageOf(lcmFingerprint<Status>())));
}

TEST(Versions, TheWarningSaysWhoIsTooOld) {
  EXPECT_EQ(warningOf({true, 6, 6}, 1, "DDS domain 0"),
            "a daemon of wire version 6 casts groom 1 on DDS domain 0; this program speaks 7: update the "
            "older one");
  EXPECT_EQ(warningOf({false, 2, 6}, 3, "LCM x"),
            "a program of wire version 2 to 6 wants groom 3 on LCM x and gets nothing: this daemon speaks 7: "
            "update the older one");
  EXPECT_NE(warningOf({true, 0, 0}, 1, "").find("a newer wire version"), std::string::npos);
}

TEST(Versions, BothEndsOfLcmHearOfTheOther) {
  const auto link = std::make_shared<LossyLink>();
  const auto becomesTrue = [](const auto& condition) {
    return trueWithin(std::chrono::seconds(30), condition);
  };
  const auto reader = makeLcmSubscriber(link, {"", 7, 0, {}});
  LcmOptions without_frames{"", 7, 0, {}};
  without_frames.frames = false;
  const auto commander = makeLcmSubscriber(link, without_frames);
  const auto daemon = makeLcmPublisher(link, {"", 7, 5, {}});
  EXPECT_FALSE(reader->otherVersion() || daemon->otherVersion());
  link->send("STRANDCAST_GUIDES_7", messageOf(kGuides6));
  link->send("STRANDCAST_STATUS", messageOf(kStatus6));
  link->send("STRANDCAST_READER_7", messageOf(kReader6));
  EXPECT_TRUE(becomesTrue([&] { return daemon->otherVersion() == OtherVersion{false, 2, 6}; }));
  EXPECT_TRUE(becomesTrue([&] { return commander->otherVersion() == OtherVersion{true, 5, 6}; }));
  EXPECT_TRUE(becomesTrue([&] { return reader->otherVersion().has_value(); }));
  EXPECT_TRUE(becomesTrue([&] { return !reader->otherVersion(); })) << "silent for 3 s";
}

}  // namespace
}  // namespace strandcast
