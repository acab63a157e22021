#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "apps/cli/verbs.h"
#include "options/console.h"
#include "options/number_range.h"
#include "transport/security/test_authority.h"

namespace strandcast {
namespace {

struct KeysOptions {
  std::filesystem::path folder;
  int days = 365;
  bool json = false;
};

const char* rightsOf(KeyRole role) {
  switch (role) {
    case KeyRole::kDaemon:
      return "publishes and obeys";
    case KeyRole::kRenderer:
      return "reads, commands and sends poses";
    case KeyRole::kPoser:
      return "sends poses";
    case KeyRole::kReader:
      break;
  }
  return "reads";
}

int makeKeys(const KeysOptions& o) {
  const std::vector<TestIdentity> identities = makeTestKeys(o.folder, o.days);
  if (o.json) {
    nlohmann::json out = {{"ca", (o.folder / "ca").string()}, {"days", o.days}};
    for (const TestIdentity& identity : identities) {
      out["identities"].push_back({{"role", nameOf(identity.role)},
                                   {"folder", identity.folder.string()},
                                   {"subject", identity.subject},
                                   {"may", rightsOf(identity.role)}});
    }
    fmt::print("{}\n", jsonText(out));
    return 0;
  }
  for (const TestIdentity& identity : identities) {
    fmt::print("{:<32} {:<24} {}\n", identity.folder.string(), identity.subject, rightsOf(identity.role));
  }
  fmt::print("{:<32} {:<24} keep it off the network\n", (o.folder / "ca").string(), "CN=strandcast test CA");
  fmt::print("valid for {} days\n", o.days);
  return 0;
}

}  // namespace

Verb addKeys(CLI::App& app) {
  const auto o = std::make_shared<KeysOptions>();
  app.footer(
      "Makes what --profile secure needs: a test CA, and one folder of keys each for a daemon, for a "
      "renderer, which may also command and send poses, for a poser, which may only send poses, and for a "
      "reader, which may only read. Copy to each machine only "
      "the folder that it needs, over a secure channel.\n"
      "Example:\n"
      "  strandcast keys KEYS\n"
      "  strandcastd --scene curly --profile secure --keys KEYS/daemon\n"
      "  strandcast view --profile secure --keys KEYS/renderer\n"
      "\nWith a CA of your own, each program gets a folder of the same six files:\n"
      "  key.pem, cert.pem        its private key and its certificate: `openssl ecparam -name prime256v1 "
      "-genkey -noout -out key.pem`, `openssl req -new -key key.pem -subj '/CN=studio renderer 3' -out "
      "request.pem`, and the CA issues cert.pem for the request. Elliptic curve P-256 or RSA 2048, SHA-256\n"
      "  identity_ca.cert.pem     certificate of the CA that signs identities\n"
      "  permissions_ca.cert.pem  certificate of the CA that signs the two documents; may be the same\n"
      "  governance.p7s           the same for all programs: KEYS/ca/governance.xml as it is\n"
      "  permissions.p7s          KEYS/renderer/permissions.xml, or another role's, with the program's "
      "own subject_name and validity, and optionally fewer domains and partitions (groom7 is groom id 7)\n"
      "Sign a document with `openssl smime -sign -text -in permissions.xml -out permissions.p7s -signer "
      "permissions_ca.cert.pem -inkey PERMISSIONS_CA_KEY`. The holder of the CA's key can impersonate any "
      "program: keep it off the network.");
  app.add_option("DIR", o->folder, "folder to make; it must not exist")->required();
  app.add_option("--days", o->days, "validity of keys and permissions, days")
      ->transform(wholeRange(1, 3650))
      ->capture_default_str();
  app.add_flag("--json", o->json, "print what was made as one JSON object");
  return [o] { return makeKeys(*o); };
}

}  // namespace strandcast
