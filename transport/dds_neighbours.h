#pragma once
#include <array>
#include <chrono>
#include <cstdint>
#include <fastdds/dds/domain/DomainParticipantListener.hpp>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "transport/status_board.h"
#include "transport/wire_fields.h"

namespace strandcast {

/// The role that a program states in its participant's user data, so that a starting daemon knows which
/// participants may be rivals: docs/wire.md, "Start".
struct DdsRole {
  bool is_daemon = false;
  uint32_t groom_id = 0;
  bool claims = false;  ///< a daemon that shares the groom

  bool operator==(const DdsRole&) const = default;
};
/// The user data that states a role, and its inverse roleOf().
std::vector<uint8_t> userDataOf(const DdsRole& role);
/// Nothing where the bytes state no role.
std::optional<DdsRole> roleOf(std::span<const uint8_t> user_data);

/// The other participants of a domain. Discovery finds participants by single datagrams, which each repeats,
/// long before it finds their readers and writers. Thread-safe.
class DdsNeighbours final : public eprosima::fastdds::dds::DomainParticipantListener {
 public:
  /// `found_other`, which may be empty, is called in a thread of discovery when otherVersion() may have
  /// changed.
  explicit DdsNeighbours(std::function<void()> found_other = {}) : found_other_(std::move(found_other)) {}

  void on_participant_discovery(eprosima::fastdds::dds::DomainParticipant* participant,
                                eprosima::fastrtps::rtps::ParticipantDiscoveryInfo&& info) override;

  void on_publisher_discovery(eprosima::fastdds::dds::DomainParticipant* participant,
                              eprosima::fastrtps::rtps::WriterDiscoveryInfo&& info) override;

  void on_subscriber_discovery(eprosima::fastdds::dds::DomainParticipant* participant,
                               eprosima::fastrtps::rtps::ReaderDiscoveryInfo&& info) override;

  // Once a participant is known to have another version of the wire, the first three leave it out.

  /// Number of participants that may cast this groom: its daemons (without its claimants, if `own_claims`),
  /// and participants without a role.
  size_t possibleConflicts(uint32_t groom_id, bool own_claims) const;
  /// Number of participants without a role: programs with keys, programs of others, versions before roles.
  size_t participantsWithoutRole() const;
  /// Whether a daemon of this groom has been known for longer than `finding`. For a daemon that shares the
  /// groom, and may be a silent standby, the bound is `claimant`.
  bool hasSilentDaemon(uint32_t groom_id, std::chrono::milliseconds finding,
                       std::chrono::milliseconds claimant) const;
  /// The role of the participant that owns this writer.
  std::optional<DdsRole> roleOfWriter(const StatusBoard::WriterId& writer) const;
  /// The participants that claim this groom, by GUID prefix, with the time since when each is known.
  using Prefix = std::array<uint8_t, 12>;
  using Times = std::map<Prefix, std::chrono::steady_clock::time_point>;
  Times claimants(uint32_t groom_id) const;
  /// Whether a daemon of this groom has been known for `time` or longer without any of its writers being
  /// discovered: its packets do not arrive here.
  bool hasDaemonWithoutWriters(uint32_t groom_id, std::chrono::milliseconds time) const;
  /// A participant of another version of the wire that casts this groom (`is_daemon`), or wants it, if there
  /// is one.
  std::optional<OtherVersion> otherVersion(uint32_t groom_id, bool is_daemon) const;
  /// Ownership strength of the participant's writer of claims; nothing where none was discovered.
  std::optional<uint32_t> strengthOf(const Prefix& prefix) const;

 private:
  struct Neighbour {
    std::optional<DdsRole> role;
    std::chrono::steady_clock::time_point since = std::chrono::steady_clock::now();
    bool has_writer = false;                ///< a writer of it was discovered
    std::optional<uint32_t> strength;       ///< of its claims
    int version = kWireVersion;             ///< of the wire, by the types of its readers and writers
    std::vector<std::string> casts, wants;  ///< partitions where it writes and reads frames, or commands
    bool isOther() const { return version != kWireVersion; }
  };
  /// Whether a reader or writer tells that its participant has another version, and what it wants or casts.
  template <class Info>
  bool noteVersion(Neighbour& neighbour, const Info& info, bool is_writer);
  const std::function<void()> found_other_;
  mutable std::mutex mutex_;
  std::map<Prefix, Neighbour> known_;
};

/// The part of a writer's GUID that all writers of a participant share.
DdsNeighbours::Prefix prefixOf(const StatusBoard::WriterId& writer);

}  // namespace strandcast
