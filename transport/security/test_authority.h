#pragma once
#include <ctime>
#include <filesystem>
#include <string>
#include <vector>

namespace strandcast {

/// Permissions of a program with the profile `secure`.
enum class KeyRole {
  kDaemon,    ///< casts grooms, shares them with other daemons, executes commands
  kRenderer,  ///< reads everything, sends commands and poses
  kPoser,     ///< sends poses, hears statuses
  kReader     ///< reads everything
};

/// "daemon", "renderer", "poser" or "reader".
const char* nameOf(KeyRole role);

/// The unsigned documents of OMG DDS Security 1.1, section 9.4.

/// Governance: unknown participants are refused, everything is encrypted, and access is by permission.
std::string governanceXml();

/// Permissions of the program whose certificate has this subject (RFC 2253, "CN=..."), between the two times.
std::string permissionsXml(KeyRole role, const std::string& subject, std::time_t not_before,
                           std::time_t not_after);

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
