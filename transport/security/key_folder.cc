#include "transport/security/key_folder.h"

#include <openssl/err.h>
#include <openssl/pem.h>

#include <cerrno>
#include <cstring>
#include <ctime>
#include <fstream>
#include <iomanip>
#include <sstream>
#include <string>

#include "core/error.h"
#include "transport/security/openssl_handles.h"

namespace strandcast {
namespace {

constexpr std::streamsize kMaxBytes = 1 << 20;
const char* const kNewKeys = "ask the CA for a new one, or make new test keys with `strandcast keys`";

std::string bytesOf(const std::filesystem::path& file) {
  errno = 0;
  std::ifstream stream(file, std::ios::binary);
  std::string bytes;
  if (stream) {
    bytes.resize(kMaxBytes);
    stream.read(bytes.data(), kMaxBytes);
    bytes.resize(static_cast<size_t>(stream.gcount()));
  }
  if (bytes.empty()) {
    throw Error(std::string("a key file cannot be read") +
                    (errno != 0 ? std::string(" (") + std::strerror(errno) + ")" : ""),
                file.string(),
                "--keys takes the folder of one identity, such as KEYS/daemon of `strandcast keys KEYS`");
  }
  return bytes;
}

void refuseOutOfForce(const X509& certificate, const std::filesystem::path& file) {
  if (X509_cmp_current_time(X509_get0_notBefore(&certificate)) > 0)
    throw Error("the certificate is not in force yet", file.string(), "is the clock of this machine right?");
  if (X509_cmp_current_time(X509_get0_notAfter(&certificate)) < 0)
    throw Error("the certificate has expired", file.string(), kNewKeys);
}

CertificateHandle readCertificate(const std::filesystem::path& file) {
  const std::string bytes = bytesOf(file);
  CertificateHandle certificate(PEM_read_bio_X509(memoryOf(bytes).get(), nullptr, nullptr, nullptr));
  if (!certificate) throw Error("not a certificate (X.509 in PEM)", file.string(), kNewKeys);
  refuseOutOfForce(*certificate, file);
  return certificate;
}

KeyHandle readKey(const std::filesystem::path& file) {
  const std::string bytes = bytesOf(file);
  bool is_locked = false;
  const auto no_password = [](char*, int, int, void* asked) {
    *static_cast<bool*>(asked) = true;
    return -1;
  };
  KeyHandle key(PEM_read_bio_PrivateKey(memoryOf(bytes).get(), nullptr, no_password, &is_locked));
  if (is_locked) {
    throw Error("the private key is locked with a password", file.string(),
                "a program that runs by itself needs it open: `openssl pkey -in LOCKED -out key.pem`");
  }
  if (!key) throw Error("not a private key (PEM)", file.string(), kNewKeys);
  return key;
}

StoreHandle storeOf(X509& authority) {
  StoreHandle store(X509_STORE_new());
  X509_STORE_add_cert(store.get(), &authority);
  return store;
}

void checkIdentity(X509& certificate, EVP_PKEY& key, X509& authority, const std::filesystem::path& folder) {
  if (X509_check_private_key(&certificate, &key) != 1) {
    throw Error("the private key is not that of the certificate", (folder / kPrivateKey).string(),
                std::string("put the key that ") + kCertificate + " was made for beside it");
  }
  const StoreHandle store = storeOf(authority);
  const StoreContextHandle context(X509_STORE_CTX_new());
  X509_STORE_CTX_init(context.get(), store.get(), &certificate, nullptr);
  if (X509_verify_cert(context.get()) != 1) {
    throw Error(std::string("the certificate is not vouched for by ") + kIdentityCa + " (" +
                    X509_verify_cert_error_string(X509_STORE_CTX_get_error(context.get())) + ")",
                (folder / kCertificate).string(), kNewKeys);
  }
}

/// The content of a document that `authority` signed.
std::string readSigned(const std::filesystem::path& file, X509& authority) {
  const std::string bytes = bytesOf(file);
  BIO* contents = nullptr;
  const SignatureHandle signature(SMIME_read_PKCS7(memoryOf(bytes).get(), &contents));
  const BioHandle owned_contents(contents);
  if (!signature) {
    throw Error("not a signed document (S/MIME)", file.string(),
                "sign the XML file with `openssl smime -sign -text`: `strandcast keys --help` shows how");
  }
  STACK_OF(X509)* const signers = sk_X509_new_null();
  sk_X509_push(signers, &authority);
  const BioHandle document(BIO_new(BIO_s_mem()));
  const StoreHandle store = storeOf(authority);
  const bool is_signed = PKCS7_verify(signature.get(), signers, store.get(), contents, document.get(),
                                      PKCS7_TEXT | PKCS7_NOVERIFY | PKCS7_NOINTERN) == 1;
  sk_X509_free(signers);
  if (!is_signed) {
    throw Error(std::string("the document is changed, or not signed by ") + kPermissionsCa, file.string(),
                "have that CA sign it again");
  }
  char* text = nullptr;
  const long size = BIO_get_mem_data(document.get(), &text);
  return {text, static_cast<size_t>(size)};
}

/// Whether every grant of the document has expired.
bool hasEnded(const std::string& permissions) {
  const std::string tag = "<not_after>";
  bool any = false;
  for (size_t at = permissions.find(tag); at != std::string::npos; at = permissions.find(tag, at + 1)) {
    std::tm end{};
    std::istringstream text(permissions.substr(at + tag.size(), 64));
    text >> std::get_time(&end, "%Y-%m-%dT%T");
    end.tm_isdst = -1;
    if (!text || std::mktime(&end) > std::time(nullptr)) return false;
    any = true;
  }
  return any;
}

}  // namespace

void checkKeyFolder(const std::filesystem::path& folder) {
  std::error_code ignored;
  if (!std::filesystem::is_directory(folder, ignored)) {
    throw Error("there is no folder of keys", folder.string(),
                "`strandcast keys KEYS` makes some for tests; give --keys KEYS/daemon or KEYS/renderer");
  }
  const CertificateHandle identity_ca = readCertificate(folder / kIdentityCa);
  const CertificateHandle permissions_ca = readCertificate(folder / kPermissionsCa);
  const CertificateHandle certificate = readCertificate(folder / kCertificate);
  checkIdentity(*certificate, *readKey(folder / kPrivateKey), *identity_ca, folder);
  readSigned(folder / kGovernance, *permissions_ca);
  if (hasEnded(readSigned(folder / kPermissions, *permissions_ca)))
    throw Error("the permissions have ended", (folder / kPermissions).string(), kNewKeys);
  ERR_clear_error();
}

}  // namespace strandcast
