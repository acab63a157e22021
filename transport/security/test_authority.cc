#include "transport/security/test_authority.h"

#include <fcntl.h>
#include <openssl/ec.h>
#include <openssl/err.h>
#include <openssl/pem.h>
#include <openssl/rand.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <ctime>
#include <initializer_list>

#include "core/error.h"
#include "transport/security/key_folder.h"
#include "transport/security/openssl_handles.h"

namespace strandcast {
namespace {

const char* const kHead = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n";
const char* const kEveryDomain = "<domains><id_range><min>0</min><max>232</max></id_range></domains>\n";

// Topics of a groom are in the partition "groom" followed by its id; the status is in none.
const char* const kGroomPartitions = "<partitions><partition>groom*</partition></partitions>";

std::string criteria(const char* action, const char* topic, const char* partitions) {
  return "      <" + std::string(action) + "><topics><topic>strandcast/" + topic + "</topic></topics>" +
         partitions + "</" + action + ">\n";
}

std::string ofGrooms(const char* action, std::initializer_list<const char*> topics) {
  std::string text;
  for (const char* const topic : topics) text += criteria(action, topic, kGroomPartitions);
  return text;
}

std::string rules(KeyRole role) {
  const std::string hears_status = criteria("subscribe", "status", "");
  switch (role) {
    case KeyRole::kDaemon:
      return ofGrooms("publish", {"groom", "hairs", "bodies", "colliders", "guides", "claim", "show"}) +
             criteria("publish", "status", "") +
             ofGrooms("subscribe", {"command", "pose", "claim", "show", "readers"}) + hears_status;
    case KeyRole::kRenderer:
      return ofGrooms("publish", {"command", "pose", "readers"}) +
             ofGrooms("subscribe", {"groom", "hairs", "bodies", "colliders", "guides"}) + hears_status;
    case KeyRole::kPoser:
      return ofGrooms("publish", {"pose"}) + hears_status;
    case KeyRole::kReader:
      break;
  }
  return ofGrooms("publish", {"readers"}) +
         ofGrooms("subscribe", {"groom", "hairs", "bodies", "colliders", "guides"}) + hears_status;
}

std::string timeText(std::time_t time) {
  // Fast DDS 2.9 reads it as local time.
  std::tm parts{};
  localtime_r(&time, &parts);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%S", &parts);
  return text;
}

}  // namespace

const char* nameOf(KeyRole role) {
  switch (role) {
    case KeyRole::kDaemon:
      return "daemon";
    case KeyRole::kRenderer:
      return "renderer";
    case KeyRole::kPoser:
      return "poser";
    case KeyRole::kReader:
      break;
  }
  return "reader";
}

std::string governanceXml() {
  return std::string(kHead) + "<dds>\n<domain_access_rules>\n  <domain_rule>\n    " + kEveryDomain +
         "    <allow_unauthenticated_participants>false</allow_unauthenticated_participants>\n"
         "    <enable_join_access_control>true</enable_join_access_control>\n"
         "    <discovery_protection_kind>ENCRYPT</discovery_protection_kind>\n"
         "    <liveliness_protection_kind>ENCRYPT</liveliness_protection_kind>\n"
         "    <rtps_protection_kind>NONE</rtps_protection_kind>\n"
         "    <topic_access_rules>\n"
         "      <topic_rule>\n"
         "        <topic_expression>*</topic_expression>\n"
         "        <enable_discovery_protection>true</enable_discovery_protection>\n"
         "        <enable_liveliness_protection>true</enable_liveliness_protection>\n"
         "        <enable_read_access_control>true</enable_read_access_control>\n"
         "        <enable_write_access_control>true</enable_write_access_control>\n"
         "        <metadata_protection_kind>ENCRYPT</metadata_protection_kind>\n"
         "        <data_protection_kind>NONE</data_protection_kind>\n"
         "      </topic_rule>\n"
         "    </topic_access_rules>\n"
         "  </domain_rule>\n</domain_access_rules>\n</dds>\n";
}

std::string permissionsXml(KeyRole role, const std::string& subject, std::time_t not_before,
                           std::time_t not_after) {
  return std::string(kHead) + "<dds>\n<permissions>\n  <grant name=\"" + nameOf(role) +
         "\">\n    <subject_name>" + subject + "</subject_name>\n    <validity><not_before>" +
         timeText(not_before) + "</not_before><not_after>" + timeText(not_after) +
         "</not_after></validity>\n    <allow_rule>\n      " + kEveryDomain + rules(role) +
         "    </allow_rule>\n    <default>DENY</default>\n  </grant>\n</permissions>\n</dds>\n";
}

namespace {

constexpr long kDay = 24 * 3600;

void require(bool done, const char* what) {
  if (done) return;
  char reason[256];
  ERR_error_string_n(ERR_get_error(), reason, sizeof reason);
  throw Error(std::string("OpenSSL cannot make ") + what, reason, "");
}

struct Identity {
  KeyHandle key;
  CertificateHandle certificate;
};

void addExtension(X509& certificate, X509& issuer, int kind, const char* value) {
  X509V3_CTX context;
  X509V3_set_ctx(&context, &issuer, &certificate, nullptr, nullptr, 0);
  X509_EXTENSION* const extension = X509V3_EXT_conf_nid(nullptr, &context, kind, value);
  require(extension != nullptr && X509_add_ext(&certificate, extension, -1) == 1, "an extension");
  X509_EXTENSION_free(extension);
}

/// Signed by `authority`, or self-signed where that is null.
Identity makeIdentity(const std::string& common_name, int days, const Identity* authority) {
  Identity identity{KeyHandle(EVP_EC_gen("P-256")), CertificateHandle(X509_new())};
  require(identity.key != nullptr && identity.certificate != nullptr, "a key");
  X509& certificate = *identity.certificate;
  X509& issuer = authority ? *authority->certificate : certificate;
  X509_set_version(&certificate, X509_VERSION_3);
  unsigned char serial[16];
  require(RAND_bytes(serial, sizeof serial) == 1, "a random number");
  serial[0] &= 0x7f;  // positive
  const std::unique_ptr<BIGNUM, FreedBy<BN_free>> number(BN_bin2bn(serial, sizeof serial, nullptr));
  BN_to_ASN1_INTEGER(number.get(), X509_get_serialNumber(&certificate));
  X509_gmtime_adj(X509_getm_notBefore(&certificate), -kDay);
  X509_gmtime_adj(X509_getm_notAfter(&certificate), days * kDay);
  X509_NAME_add_entry_by_txt(X509_get_subject_name(&certificate), "CN", MBSTRING_UTF8,
                             reinterpret_cast<const unsigned char*>(common_name.c_str()), -1, -1, 0);
  X509_set_issuer_name(&certificate, X509_get_subject_name(&issuer));
  X509_set_pubkey(&certificate, identity.key.get());
  addExtension(certificate, issuer, NID_basic_constraints,
               authority ? "critical,CA:FALSE" : "critical,CA:TRUE");
  addExtension(
      certificate, issuer, NID_key_usage,
      authority ? "critical,digitalSignature,keyAgreement" : "critical,keyCertSign,cRLSign,digitalSignature");
  EVP_PKEY* const signer = authority ? authority->key.get() : identity.key.get();
  require(X509_sign(&certificate, signer, EVP_sha256()) > 0, "a certificate");
  return identity;
}

void write(const std::filesystem::path& file, BIO& bytes, mode_t mode) {
  char* data = nullptr;
  const long size = BIO_get_mem_data(&bytes, &data);
  const int out = open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, mode);
  long left = out >= 0 ? size : -1;
  while (left > 0) {  // on a full disk the first write succeeds in part, and the next one reports the cause
    const ssize_t put = ::write(out, data + (size - left), static_cast<size_t>(left));
    if (put <= 0) break;
    left -= put;
  }
  const int cause = errno;
  if (out >= 0) close(out);
  if (left != 0) throw Error("a key file cannot be written", file.string(), std::strerror(cause));
}

constexpr mode_t kPublic = 0644, kSecret = 0600;

void writeCertificate(const std::filesystem::path& file, X509& certificate) {
  const BioHandle bytes(BIO_new(BIO_s_mem()));
  PEM_write_bio_X509(bytes.get(), &certificate);
  write(file, *bytes, kPublic);
}

void writeKey(const std::filesystem::path& file, EVP_PKEY& key) {
  const BioHandle bytes(BIO_new(BIO_s_mem()));
  PEM_write_bio_PrivateKey(bytes.get(), &key, nullptr, nullptr, 0, nullptr, nullptr);
  write(file, *bytes, kSecret);
}

void writeSigned(const std::filesystem::path& file, const std::string& document, const Identity& authority) {
  constexpr int kFlags = PKCS7_TEXT | PKCS7_DETACHED;
  const BioHandle bytes(BIO_new(BIO_s_mem()));
  const SignatureHandle signature(PKCS7_sign(authority.certificate.get(), authority.key.get(), nullptr,
                                             memoryOf(document).get(), kFlags));
  require(signature != nullptr, "a signature");
  require(SMIME_write_PKCS7(bytes.get(), signature.get(), memoryOf(document).get(), kFlags) == 1,
          "a signed document");
  write(file, *bytes, kPublic);
}

/// Builds a folder beside its final path and renames it when complete; removes everything otherwise.
class NewFolder {
 public:
  explicit NewFolder(const std::filesystem::path& place)
      : place_(place.has_filename() ? place : place.parent_path()),
        beside_(place_.string() + "." + std::to_string(getpid())) {
    std::error_code failure;
    std::filesystem::path parent = beside_.parent_path();
    for (; std::filesystem::status(parent, failure).type() == std::filesystem::file_type::not_found &&
           !parent.empty();
         parent = parent.parent_path())
      new_parents_.push_back(parent);
    make(beside_);
  }
  ~NewFolder() {
    if (!is_kept_) remove();
  }
  NewFolder(const NewFolder&) = delete;
  NewFolder& operator=(const NewFolder&) = delete;

  const std::filesystem::path& path() const { return beside_; }
  void make(const std::filesystem::path& folder) {
    std::error_code failure;
    std::filesystem::create_directories(folder, failure);
    if (failure) fail(failure);
  }
  void keep() {
    std::error_code failure;
    std::filesystem::rename(beside_, place_, failure);
    if (failure) fail(failure);
    is_kept_ = true;
  }

 private:
  [[noreturn]] void fail(std::error_code cause) {
    remove();
    throw Error("the folder cannot be made", place_.string(), cause.message());
  }
  void remove() {
    std::error_code ignored;
    std::filesystem::remove_all(beside_, ignored);
    for (const std::filesystem::path& parent : new_parents_) std::filesystem::remove(parent, ignored);
  }

  const std::filesystem::path place_, beside_;
  std::vector<std::filesystem::path> new_parents_;  // innermost first
  bool is_kept_ = false;
};

}  // namespace

std::vector<TestIdentity> makeTestKeys(const std::filesystem::path& folder, int days) {
  if (folder.empty()) throw Error("no folder is named for the keys", "''", "name a new one");
  std::error_code failure;
  if (std::filesystem::exists(folder, failure))
    throw Error("there is something already", folder.string(), "name a new folder; nothing is replaced");
  NewFolder made(folder);
  const std::filesystem::path ca = made.path() / "ca";
  made.make(ca);

  const Identity authority = makeIdentity("strandcast test CA", days, nullptr);
  writeCertificate(ca / kCertificate, *authority.certificate);
  writeKey(ca / kPrivateKey, *authority.key);
  const std::string governance = governanceXml();
  write(ca / "governance.xml", *memoryOf(governance), kPublic);

  const std::time_t now = std::time(nullptr);
  std::vector<TestIdentity> identities;
  for (const KeyRole role : {KeyRole::kDaemon, KeyRole::kRenderer, KeyRole::kPoser, KeyRole::kReader}) {
    const std::string name = std::string("strandcast ") + nameOf(role);
    const std::filesystem::path own = made.path() / nameOf(role);
    made.make(own);
    const Identity identity = makeIdentity(name, days, &authority);
    writeCertificate(own / kIdentityCa, *authority.certificate);
    writeCertificate(own / kPermissionsCa, *authority.certificate);
    writeCertificate(own / kCertificate, *identity.certificate);
    writeKey(own / kPrivateKey, *identity.key);
    writeSigned(own / kGovernance, governance, authority);
    const std::string permissions = permissionsXml(role, "CN=" + name, now - kDay, now + days * kDay);
    write(own / "permissions.xml", *memoryOf(permissions), kPublic);
    writeSigned(own / kPermissions, permissions, authority);
    identities.push_back({role, folder / nameOf(role), "CN=" + name});
  }
  made.keep();
  return identities;
}

}  // namespace strandcast
