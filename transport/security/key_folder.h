#pragma once
#include <filesystem>

namespace strandcast {

/// The six files that one program needs for the profile `secure`, in one folder, named as in an enclave of
/// ROS 2.
inline constexpr const char* kIdentityCa = "identity_ca.cert.pem";        ///< issuer of certificates
inline constexpr const char* kCertificate = "cert.pem";                   ///< of this program, by that CA
inline constexpr const char* kPrivateKey = "key.pem";                     ///< of this program
inline constexpr const char* kPermissionsCa = "permissions_ca.cert.pem";  ///< issuer of permissions
inline constexpr const char* kGovernance = "governance.p7s";    ///< S/MIME, signed by the permissions CA
inline constexpr const char* kPermissions = "permissions.p7s";  ///< likewise

/// Throws Error, naming the file and a remedy, unless the folder has all six, readable, valid now and
/// consistent. It does not check whether the permissions name this program: DDS does.
void checkKeyFolder(const std::filesystem::path& folder);

}  // namespace strandcast
