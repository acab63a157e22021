#include "transport/dds_neighbours.h"

#include <algorithm>
#include <charconv>
#include <string>
#include <string_view>

#include "transport/dds_participant.h"
#include "transport/versions.h"

namespace strandcast {
namespace {

constexpr std::string_view kMark = "strandcast;", kDaemonWord = "daemon;", kReaderWord = "reader;",
                           kClaimWord = ";claim";

/// Removes `word` from the front of `text`; false if it is not there.
bool takeWord(std::string_view& text, std::string_view word) {
  if (text.substr(0, word.size()) != word) return false;
  text.remove_prefix(word.size());
  return true;
}

}  // namespace

std::vector<uint8_t> userDataOf(const DdsRole& role) {
  std::string text(kMark);
  text += role.is_daemon ? kDaemonWord : kReaderWord;
  text += std::to_string(role.groom_id);
  if (role.claims) text += kClaimWord;
  return {text.begin(), text.end()};
}

std::optional<DdsRole> roleOf(std::span<const uint8_t> user_data) {
  std::string_view text(reinterpret_cast<const char*>(user_data.data()), user_data.size());
  if (!takeWord(text, kMark)) return std::nullopt;
  DdsRole role;
  role.is_daemon = takeWord(text, kDaemonWord);
  if (!role.is_daemon && !takeWord(text, kReaderWord)) return std::nullopt;
  const auto [rest, failure] = std::from_chars(text.data(), text.data() + text.size(), role.groom_id);
  if (failure != std::errc()) return std::nullopt;
  text.remove_prefix(static_cast<size_t>(rest - text.data()));
  role.claims = role.is_daemon && takeWord(text, kClaimWord);
  return text.empty() ? std::optional(role) : std::nullopt;
}

DdsNeighbours::Prefix prefixOf(const StatusBoard::WriterId& writer) {
  DdsNeighbours::Prefix prefix;
  std::copy_n(writer.begin(), prefix.size(), prefix.begin());
  return prefix;
}

void DdsNeighbours::on_participant_discovery(eprosima::fastdds::dds::DomainParticipant*,
                                             eprosima::fastrtps::rtps::ParticipantDiscoveryInfo&& info) {
  using Discovery = eprosima::fastrtps::rtps::ParticipantDiscoveryInfo;
  Prefix prefix;
  std::copy_n(info.info.m_guid.guidPrefix.value, prefix.size(), prefix.begin());
  const std::lock_guard lock(mutex_);
  if (info.status == Discovery::REMOVED_PARTICIPANT || info.status == Discovery::DROPPED_PARTICIPANT)
    known_.erase(prefix);
  else
    known_[prefix].role = roleOf(info.info.m_userData.data_vec());
}

void DdsNeighbours::on_publisher_discovery(eprosima::fastdds::dds::DomainParticipant*,
                                           eprosima::fastrtps::rtps::WriterDiscoveryInfo&& info) {
  using Discovery = eprosima::fastrtps::rtps::WriterDiscoveryInfo;
  if (info.status == Discovery::REMOVED_WRITER) return;
  Prefix prefix;
  std::copy_n(info.info.guid().guidPrefix.value, prefix.size(), prefix.begin());
  const bool claims = info.info.topicName() == kClaimTopic.name;
  {
    const std::lock_guard lock(mutex_);
    const auto known = known_.find(prefix);
    if (known == known_.end()) return;
    known->second.has_writer = true;
    if (claims) known->second.strength = info.info.m_qos.m_ownershipStrength.value;
    if (!noteVersion(known->second, info.info, true)) return;
  }
  if (found_other_) found_other_();
}

void DdsNeighbours::on_subscriber_discovery(eprosima::fastdds::dds::DomainParticipant*,
                                            eprosima::fastrtps::rtps::ReaderDiscoveryInfo&& info) {
  using Discovery = eprosima::fastrtps::rtps::ReaderDiscoveryInfo;
  if (info.status == Discovery::REMOVED_READER) return;
  Prefix prefix;
  std::copy_n(info.info.guid().guidPrefix.value, prefix.size(), prefix.begin());
  {
    const std::lock_guard lock(mutex_);
    const auto known = known_.find(prefix);
    if (known == known_.end() || !noteVersion(known->second, info.info, false)) return;
  }
  if (found_other_) found_other_();
}

template <class Info>
bool DdsNeighbours::noteVersion(Neighbour& neighbour, const Info& info, bool is_writer) {
  const int version = versionOfType(info.typeName().to_string());
  if (version == 0 || version == kWireVersion) return false;
  neighbour.version = version;
  const bool is_of_frames = info.topicName() == kGuidesTopic.name;
  std::vector<std::string>* const partitions =
      is_of_frames ? (is_writer ? &neighbour.casts : &neighbour.wants)
      : is_writer && info.topicName() == kCommandTopic.name ? &neighbour.wants
                                                            : nullptr;
  if (partitions != nullptr) *partitions = info.m_qos.m_partition.names();
  return partitions != nullptr;
}

std::optional<OtherVersion> DdsNeighbours::otherVersion(uint32_t groom_id, bool is_daemon) const {
  const std::string partition = "groom" + std::to_string(groom_id);
  const std::lock_guard lock(mutex_);
  for (const auto& [prefix, neighbour] : known_) {
    const std::vector<std::string>& partitions = is_daemon ? neighbour.casts : neighbour.wants;
    if (!neighbour.isOther() ||
        std::find(partitions.begin(), partitions.end(), partition) == partitions.end())
      continue;
    const int version = neighbour.version < kWireVersion ? neighbour.version : 0;
    return OtherVersion{is_daemon, version, version};
  }
  return std::nullopt;
}

size_t DdsNeighbours::possibleConflicts(uint32_t groom_id, bool own_claims) const {
  const std::lock_guard lock(mutex_);
  return static_cast<size_t>(std::count_if(known_.begin(), known_.end(), [&](const auto& known) {
    const std::optional<DdsRole>& role = known.second.role;
    if (known.second.isOther()) return false;
    return !role || (role->is_daemon && role->groom_id == groom_id && !(own_claims && role->claims));
  }));
}

size_t DdsNeighbours::participantsWithoutRole() const {
  const std::lock_guard lock(mutex_);
  return static_cast<size_t>(std::count_if(known_.begin(), known_.end(), [](const auto& known) {
    return !known.second.role && !known.second.isOther();
  }));
}

bool DdsNeighbours::hasSilentDaemon(uint32_t groom_id, std::chrono::milliseconds finding,
                                    std::chrono::milliseconds claimant) const {
  const auto now = std::chrono::steady_clock::now();
  const std::lock_guard lock(mutex_);
  return std::any_of(known_.begin(), known_.end(), [&](const auto& known) {
    const std::optional<DdsRole>& role = known.second.role;
    return role && role->is_daemon && role->groom_id == groom_id && !known.second.isOther() &&
           now - known.second.since > (role->claims ? claimant : finding);
  });
}

std::optional<DdsRole> DdsNeighbours::roleOfWriter(const StatusBoard::WriterId& writer) const {
  const std::lock_guard lock(mutex_);
  const auto known = known_.find(prefixOf(writer));
  return known == known_.end() ? std::nullopt : known->second.role;
}

bool DdsNeighbours::hasDaemonWithoutWriters(uint32_t groom_id, std::chrono::milliseconds time) const {
  const auto now = std::chrono::steady_clock::now();
  const std::lock_guard lock(mutex_);
  return std::any_of(known_.begin(), known_.end(), [&](const auto& known) {
    const Neighbour& neighbour = known.second;
    return neighbour.role && neighbour.role->is_daemon && neighbour.role->groom_id == groom_id &&
           !neighbour.has_writer && now - neighbour.since >= time;
  });
}

std::optional<uint32_t> DdsNeighbours::strengthOf(const Prefix& prefix) const {
  const std::lock_guard lock(mutex_);
  const auto known = known_.find(prefix);
  return known == known_.end() ? std::nullopt : known->second.strength;
}

DdsNeighbours::Times DdsNeighbours::claimants(uint32_t groom_id) const {
  Times times;
  const std::lock_guard lock(mutex_);
  for (const auto& [prefix, neighbour] : known_)
    if (neighbour.role && neighbour.role->claims && neighbour.role->groom_id == groom_id)
      times[prefix] = neighbour.since;
  return times;
}

}  // namespace strandcast
