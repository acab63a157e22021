// The profile `secure` with real processes: known programs have their permissions, and unknown ones receive
// nothing and have no effect.
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <future>
#include <memory>
#include <set>
#include <string>

#include "dds_domain.h"
#include "peer.h"
#include "tests/expect_error.h"
#include "tests/io/scratch_folder.h"
#include "transport/dds.h"
#include "transport/publisher.h"
#include "transport/security/key_folder.h"
#include "transport/security/test_authority.h"
#include "true_within.h"

namespace strandcast {
namespace {

using std::chrono::milliseconds;
namespace fs = std::filesystem;

DdsOptions secured(int domain, const fs::path& keys, uint64_t session = 0) {
  DdsOptions options;
  options.domain = domain;
  options.session = session;
  options.profile = DdsProfile::kSecure;
  options.keys = keys;
  return options;
}

Command commandOf(uint64_t id) {
  Command command;
  command.id = id;
  return command;
}

class Secure : public testing::Test {
 protected:
  void SetUp() override { makeTestKeys(keys_, 30); }
  std::unique_ptr<Peer> secure(std::vector<std::string> arguments, const char* role) {
    const PeerSetting profile("STRANDCAST_PEER_PROFILE", "secure"),
        keys("STRANDCAST_PEER_KEYS", (keys_ / role).string());
    return std::make_unique<Peer>(std::move(arguments));
  }
  const ScratchFolder scratch_;
  const fs::path keys_ = scratch_ / "keys";
};

TEST_F(Secure, ARivalIsHeardInTime) {
  const std::string domain = std::to_string(testDomain(5));
  const auto first = secure({"cast", domain, "60"}, "daemon");
  for (int trial = 0; trial < 2; ++trial) {  // each listens for kSecureConflictListenTime
    const auto second = secure({"publish", domain, "0.1"}, "daemon");
    EXPECT_TRUE(second->finish().contains("rival")) << second->text();
  }
}

TEST_F(Secure, WhoIsKnownReadsAndCommandsAsPermitted) {
  const std::string domain = std::to_string(testDomain(0));
  const auto daemon = secure({"cast", domain, "60"}, "daemon");
  const auto renderer = secure({"read", domain, "2", "0"}, "renderer");
  const auto reader = secure({"read", domain, "2", "0"}, "reader");
  for (Peer* const peer : {renderer.get(), reader.get()}) {
    const Results read = peer->finish();
    ASSERT_TRUE(read.contains("lost")) << peer->text();
    EXPECT_EQ(read.at("groom"), kPeerGuides);
    EXPECT_GE(read.at("received"), 30) << peer->text();
    EXPECT_EQ(read.at("wrong"), 0) << peer->text();
    std::printf("secure, %d x 16 at 60 Hz: latency p50 %.2f ms, p99 %.2f ms\n", kPeerGuides,
                read.at("latency_ms_p50"), read.at("latency_ms_p99"));
  }
  const auto refused = secure({"send", domain, "101"}, "reader");
  refused->finish();
  EXPECT_EQ(refused->exitCode(), 2);
  EXPECT_NE(refused->text().find("do not permit commands"), std::string::npos) << refused->text();
  EXPECT_EQ(refused->text().find("Fast DDS"), std::string::npos) << refused->text();
  const auto obeyed = secure({"send", domain, "102"}, "renderer");
  obeyed->finish();
  EXPECT_EQ(obeyed->exitCode(), 0) << obeyed->text();
  ASSERT_TRUE(daemon->waitFor("command")) << daemon->text();
  EXPECT_EQ(daemon->results().at("command"), 102) << "the first that it got";
}

/// Signs a document with the test CA's key.
void sign(const fs::path& keys, const std::string& document, const fs::path& file) {
  const fs::path ca = keys / "ca", unsigned_file = file.string() + ".xml";
  std::ofstream(unsigned_file) << document;
  const std::string command = "openssl smime -sign -text -in " + unsigned_file.string() + " -out " +
                              file.string() + " -signer " + (ca / kCertificate).string() + " -inkey " +
                              (ca / kPrivateKey).string();
  ASSERT_EQ(std::system(command.c_str()), 0) << "is there no openssl program?";
}

/// Replaces the test CA's governance by one without write access control, in `folder`.
void allowEverything(const fs::path& keys, const fs::path& folder) {
  std::string governance = governanceXml();
  const std::string rule = "<enable_write_access_control>true";
  governance.replace(governance.find(rule), rule.size(), "<enable_write_access_control>false");
  sign(keys, governance, folder / kGovernance);
}

TEST_F(Secure, WhoIsNotKnownHearsNothingAndWhoIsNotPermittedMovesNothing) {
  const int domain = testDomain(1);
  const auto daemon = secure({"cast", std::to_string(domain), "60"}, "daemon");
  const auto good = makeDdsSubscriber(secured(domain, keys_ / "renderer"));
  ASSERT_TRUE(good->waitForFrame(0, milliseconds(12000))) << daemon->exitReport();
  makeTestKeys(scratch_ / "foreign", 30);
  const auto stranger = makeDdsSubscriber({domain, 1, 0, {}});
  const auto foreigner = makeDdsSubscriber(secured(domain, scratch_ / "foreign" / "renderer"));
  // A program that ignores its own governance is still bound by that of the others.
  allowEverything(keys_, keys_ / "reader");
  const auto cheat = makeDdsSubscriber(secured(domain, keys_ / "reader"));
  EXPECT_TRUE(cheat->mayCommand()) << "by its own rules";
  const auto refusal = [](Subscriber& subscriber) { return errorOf([&] { subscriber.send(commandOf(7)); }); };
  auto of_cheat = std::async(std::launch::async, refusal, std::ref(*cheat));
  auto of_foreigner = std::async(std::launch::async, refusal, std::ref(*foreigner));
  const std::string of_stranger = refusal(*stranger), foreign = of_foreigner.get();
  EXPECT_NE(of_stranger.find("no daemon answers"), std::string::npos) << of_stranger;
  EXPECT_NE(of_stranger.find("answers only who has --keys"), std::string::npos) << of_stranger;
  EXPECT_NE(foreign.find("no daemon answers"), std::string::npos) << foreign;
  EXPECT_NE(foreign.find("the keys: a daemon refuses those of another CA"), std::string::npos) << foreign;
  EXPECT_NE(of_cheat.get(), "");
  for (Subscriber* const subscriber : {stranger.get(), foreigner.get()}) {
    EXPECT_FALSE(subscriber->groom());
    EXPECT_FALSE(subscriber->body());
    EXPECT_TRUE(subscriber->allStatuses().empty());
    EXPECT_EQ(subscriber->statistics().frames_received, 0u);
    EXPECT_EQ(subscriber->statistics().chunks_rejected, 0u) << "not even chunks that could not be read";
  }
  good->send(commandOf(8));
  ASSERT_TRUE(daemon->waitFor("command")) << daemon->text();
  EXPECT_EQ(daemon->results().at("command"), 8) << "the first that it got";
}

TEST_F(Secure, OnlyThosePermittedSendPoses) {
  const int domain = testDomain(6);
  const auto daemon = makeDdsPublisher(secured(domain, keys_ / "daemon", 5));
  const auto poser = makeDdsPoseSender(secured(domain, keys_ / "poser")),
             renderer = makeDdsPoseSender(secured(domain, keys_ / "renderer"));
  EXPECT_NE(errorOf([&] { makeDdsPoseSender(secured(domain, keys_ / "reader")); }).find("with these keys"),
            std::string::npos);
  EXPECT_NE(errorOf([&] { makeDdsPublisher(secured(domain, keys_ / "poser", 6)); }).find("with these keys"),
            std::string::npos);
  allowEverything(keys_, keys_ / "reader");
  const auto cheat = makeDdsPoseSender(secured(domain, keys_ / "reader"));
  const Pose pose;
  for (PoseSender* const sender : {poser.get(), renderer.get(), cheat.get()}) sender->setNames({"head"});
  std::set<uint64_t> heard;
  uint64_t time = 0;
  EXPECT_TRUE(trueWithin(milliseconds(12000), [&] {
    ++time;
    for (PoseSender* const sender : {poser.get(), renderer.get(), cheat.get()})
      sender->send(time, {&pose, 1});
    while (const std::optional<PoseSamples> taken = daemon->takePoses()) heard.insert(taken->source);
    return heard.contains(poser->source()) && heard.contains(renderer->source());
  }));
  EXPECT_FALSE(heard.contains(cheat->source())) << "by the daemon's rules";
}

TEST_F(Secure, ADaemonWithKeysFromBeforePosesCasts) {
  std::ifstream file(keys_ / "daemon" / "permissions.xml");
  std::string old;
  for (std::string line; std::getline(file, line);)
    if (line.find("strandcast/pose") == std::string::npos) old += line + '\n';
  sign(keys_, old, keys_ / "daemon" / kPermissions);
  const int domain = testDomain(7);
  const auto daemon = makeDdsPublisher(secured(domain, keys_ / "daemon", 5));
  EXPECT_FALSE(daemon->takePoses());
  const auto reader = makeDdsSubscriber(secured(domain, keys_ / "reader"));
  EXPECT_TRUE(trueWithin(milliseconds(12000), [&] { return reader->status().has_value(); }));
}

TEST_F(Secure, KeysThatDoNotFitAreRefusedAtOnce) {
  const int domain = testDomain(3);
  const auto refusal = [](const DdsOptions& options) { return errorOf([&] { makeDdsPublisher(options); }); };
  EXPECT_NE(refusal(secured(domain, keys_ / "renderer", 5)).find("with these keys"), std::string::npos)
      << "a renderer may not cast";
  EXPECT_NE(refusal(secured(domain, {}, 5)).find("the profile needs keys"), std::string::npos);
  EXPECT_NE(refusal(secured(domain, keys_, 5)).find("cannot be read"), std::string::npos);
  DdsOptions options = secured(domain, keys_ / "daemon", 5);
  options.discovery_server = "127.0.0.1:11811";
  EXPECT_NE(refusal(options).find("discovery server"), std::string::npos);
  options = secured(domain, keys_ / "daemon", 5);
  options.profile = DdsProfile::kReliableLan;
  EXPECT_NE(refusal(options).find("--profile secure"), std::string::npos);
  fs::copy_file(keys_ / "reader" / kPermissions, keys_ / "daemon" / kPermissions,
                fs::copy_options::overwrite_existing);
  EXPECT_NE(refusal(secured(domain, keys_ / "daemon", 5)).find("for the subject of cert.pem"),
            std::string::npos)
      << "permissions of another";
}

}  // namespace
}  // namespace strandcast
