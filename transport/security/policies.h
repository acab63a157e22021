#pragma once
#include <ctime>
#include <string>

namespace strandcast {

/// Permissions of a program with the profile `secure`.
enum class KeyRole {
  kDaemon,    ///< casts grooms, shares them with other daemons, executes commands
  kRenderer,  ///< reads everything, sends commands
  kReader     ///< reads everything
};

/// "daemon", "renderer" or "reader".
const char* nameOf(KeyRole role);

/// The unsigned documents of OMG DDS Security 1.1, section 9.4.

/// Governance: unknown participants are refused, everything is encrypted, and access is by permission.
std::string governanceXml();

/// Permissions of the program whose certificate has this subject (RFC 2253, "CN=..."), between the two times.
std::string permissionsXml(KeyRole role, const std::string& subject, std::time_t not_before,
                           std::time_t not_after);

}  // namespace strandcast
