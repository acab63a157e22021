// Faults of a key folder are reported before a network is joined.
#include "transport/security/key_folder.h"

#include <gtest/gtest.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "tests/expect_error.h"
#include "tests/full_disk.h"
#include "tests/io/scratch_folder.h"
#include "transport/security/test_authority.h"

namespace strandcast {
namespace {

namespace fs = std::filesystem;

std::string contents(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

void write(const fs::path& file, const std::string& bytes) { std::ofstream(file, std::ios::binary) << bytes; }

class KeyFolder : public testing::Test {
 protected:
  void SetUp() override { identities_ = makeTestKeys(scratch_ / "keys", 30); }
  /// Expects a refusal for this reason, which names the file and a remedy.
  void expectRefused(const std::string& reason, const char* file) {
    const std::string message = errorOf([&] { checkKeyFolder(daemon_); });
    EXPECT_NE(message.find(reason), std::string::npos) << message;
    EXPECT_NE(message.find((daemon_ / file).string() + "; "), std::string::npos) << message;
  }
  const ScratchFolder scratch_;
  const fs::path daemon_ = scratch_ / "keys" / "daemon", renderer_ = scratch_ / "keys" / "renderer";
  std::vector<TestIdentity> identities_;
};

TEST_F(KeyFolder, TestKeysAreSoundAndPrivate) {
  ASSERT_EQ(identities_.size(), 4u);
  for (const TestIdentity& identity : identities_) {
    EXPECT_EQ(errorOf([&] { checkKeyFolder(identity.folder); }), "");
    EXPECT_EQ(fs::status(identity.folder / kPrivateKey).permissions(),
              fs::perms::owner_read | fs::perms::owner_write);
    EXPECT_EQ(fs::exists(identity.folder / "ca"), false);
  }
  EXPECT_NE(errorOf([&] { makeTestKeys(scratch_ / "keys", 30); }).find("nothing is replaced"),
            std::string::npos);
  write(scratch_ / "file", "");
  EXPECT_NE(errorOf([&] { makeTestKeys(scratch_ / "file" / "keys", 30); }), "");
}

TEST_F(KeyFolder, OnesThatCannotBeWrittenLeaveNothing) {
  const fs::path place = scratch_ / "new" / "keys" / "";
  for (const rlim_t bytes : {100, 600, 1000}) {
    const std::string failure = errorOf([&] {
      const FullDisk disk(bytes);
      makeTestKeys(place, 30);
    });
    EXPECT_NE(failure.find("cannot be written"), std::string::npos) << failure;
    EXPECT_NE(failure.find(std::strerror(EFBIG)), std::string::npos) << failure;
    EXPECT_FALSE(fs::exists(scratch_ / "new")) << bytes;
  }
  EXPECT_EQ(errorOf([&] { checkKeyFolder(makeTestKeys(place, 30)[0].folder); }), "");
  EXPECT_EQ(std::distance(fs::directory_iterator(scratch_ / "new"), {}), 1);
}

TEST_F(KeyFolder, AMissingOrMeaninglessFileIsNamed) {
  EXPECT_NE(errorOf([&] { checkKeyFolder(scratch_ / "none"); }).find("no folder of keys"), std::string::npos);
  for (const char* file :
       {kIdentityCa, kCertificate, kPrivateKey, kPermissionsCa, kGovernance, kPermissions}) {
    const std::string sound = contents(daemon_ / file);
    fs::remove(daemon_ / file);
    expectRefused("cannot be read (No such file", file);
    fs::create_directory(daemon_ / file);
    expectRefused("cannot be read", file);
    fs::remove(daemon_ / file);
    write(daemon_ / file, "");
    expectRefused("cannot be read", file);
    write(daemon_ / file, "no key");
    expectRefused("not a", file);
    write(daemon_ / file, sound.substr(0, sound.size() / 2));
    EXPECT_NE(errorOf([&] { checkKeyFolder(daemon_); }), "") << file << " cut in half";
    write(daemon_ / file, sound);
  }
  EXPECT_EQ(errorOf([&] { checkKeyFolder(daemon_); }), "");
}

TEST_F(KeyFolder, FilesOfDifferentOriginDoNotPass) {
  const auto exchange = [&](const fs::path& from, const char* file, const char* reason) {
    const std::string sound = contents(daemon_ / file);
    write(daemon_ / file, contents(from / file));
    expectRefused(reason, file == std::string(kIdentityCa) ? kCertificate : file);
    write(daemon_ / file, sound);
  };
  makeTestKeys(scratch_ / "other", 30);
  const fs::path other = scratch_ / "other" / "daemon";
  exchange(renderer_, kPrivateKey, "not that of the certificate");
  exchange(other, kIdentityCa, "not vouched for");
  exchange(other, kGovernance, "not signed by");
  exchange(other, kPermissions, "not signed by");
  std::string governance = contents(daemon_ / kGovernance);
  governance.replace(governance.find("ENCRYPT"), 7, "NONE   ");
  write(daemon_ / kGovernance, governance);
  expectRefused("the document is changed", kGovernance);
}

TEST_F(KeyFolder, WhatIsOutOfForceIsSaid) {
  makeTestKeys(scratch_ / "old", 0);
  EXPECT_NE(errorOf([&] { checkKeyFolder(scratch_ / "old" / "daemon"); }).find("has expired"),
            std::string::npos);
  // Only the permissions have expired; the same CA has signed them.
  const fs::path ca = scratch_ / "keys" / "ca", ended = scratch_ / "ended.xml";
  write(ended, permissionsXml(KeyRole::kDaemon, "CN=strandcast daemon", 1000000000, 1100000000));
  const std::string sign = "openssl smime -sign -text -in " + ended.string() + " -out " +
                           (daemon_ / kPermissions).string() + " -signer " + (ca / kCertificate).string() +
                           " -inkey " + (ca / kPrivateKey).string();
  if (std::system(sign.c_str()) != 0) GTEST_SKIP() << "no openssl program";
  expectRefused("the permissions have ended", kPermissions);
  write(ended, permissionsXml(KeyRole::kDaemon, "CN=strandcast daemon", 1000000000, 4000000000));
  ASSERT_EQ(std::system(sign.c_str()), 0);
  EXPECT_EQ(errorOf([&] { checkKeyFolder(daemon_); }), "")
      << "as the help of `strandcast keys` tells to sign";
}

TEST_F(KeyFolder, ALockedKeyIsNotAskedFor) {
  const std::string lock = "openssl pkey -aes128 -passout pass:secret -in " +
                           (renderer_ / kPrivateKey).string() + " -out " + (daemon_ / kPrivateKey).string();
  if (std::system(lock.c_str()) != 0) GTEST_SKIP() << "no openssl program";
  expectRefused("locked with a password", kPrivateKey);
}

}  // namespace
}  // namespace strandcast
