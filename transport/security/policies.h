#pragma once
#include <ctime>
#include <string>

namespace strandcast {

/// What a program may do where the profile `secure` is used.
enum class KeyRole {
  kDaemon,    ///< casts grooms, shares them with other daemons, obeys
  kRenderer,  ///< reads everything, commands
  kReader     ///< reads everything
};

/// "daemon", "renderer" or "reader".
const char* nameOf(KeyRole role);

/// The documents of OMG DDS Security 1.1, section 9.4, before they are signed.

/// What holds for everyone: nobody unknown takes part, and everything is encrypted and allowed by name.
std::string governanceXml();

/// What whoever has a certificate of this subject (RFC 2253, "CN=...") may do between the two times.
std::string permissionsXml(KeyRole role, const std::string& subject, std::time_t not_before,
                           std::time_t not_after);

}  // namespace strandcast
