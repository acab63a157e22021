#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "transport/security/policies.h"

namespace strandcast {

/// A certificate authority for tests and for networks that need no other: it issues certificates and signs
/// permissions. Certificates are X.509 with ECDSA over P-256 and SHA-256.
struct TestIdentity {
  KeyRole role;
  std::filesystem::path folder;  ///< has all that checkKeyFolder() requires, and permissions.xml, unsigned
  std::string subject;           ///< "CN=strandcast daemon"
};

/// Makes `folder` with ca/ (cert.pem, key.pem, governance.xml unsigned) and a folder for each role. All
/// certificates and permissions are valid for `days`, beginning a day ago to tolerate clock differences.
/// Private keys are readable by their owner only. Throws Error where the folder exists or cannot be written.
std::vector<TestIdentity> makeTestKeys(const std::filesystem::path& folder, int days);

}  // namespace strandcast
