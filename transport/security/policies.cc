#include "transport/security/policies.h"

#include <initializer_list>

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
      return ofGrooms("publish", {"groom", "bodies", "colliders", "guides", "claim", "show"}) +
             criteria("publish", "status", "") + ofGrooms("subscribe", {"command", "claim", "show"}) +
             hears_status;
    case KeyRole::kRenderer:
      return ofGrooms("publish", {"command"}) +
             ofGrooms("subscribe", {"groom", "bodies", "colliders", "guides"}) + hears_status;
    case KeyRole::kReader:
      break;
  }
  return ofGrooms("subscribe", {"groom", "bodies", "colliders", "guides"}) + hears_status;
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

}  // namespace strandcast
