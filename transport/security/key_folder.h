#pragma once
#include <filesystem>

namespace strandcast {

/// What one program needs to take part where the profile `secure` is used: six files of these names in one
/// folder, as in an enclave of ROS 2.
inline constexpr const char* kIdentityCa = "identity_ca.cert.pem";        ///< who vouches for identities
inline constexpr const char* kCertificate = "cert.pem";                   ///< of this program, by that CA
inline constexpr const char* kPrivateKey = "key.pem";                     ///< of this program
inline constexpr const char* kPermissionsCa = "permissions_ca.cert.pem";  ///< who grants rights
inline constexpr const char* kGovernance = "governance.p7s";    ///< S/MIME, signed by the permissions CA
inline constexpr const char* kPermissions = "permissions.p7s";  ///< likewise

/// Throws Error, which names the file and what to do, unless the folder has all of them, readable and in
/// force, and they fit each other. Whether the permissions name this program is for DDS to tell.
void checkKeyFolder(const std::filesystem::path& folder);

}  // namespace strandcast
