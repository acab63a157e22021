#pragma once
#include <array>
#include <chrono>
#include <cstdint>
#include <fastdds/dds/domain/DomainParticipantListener.hpp>
#include <map>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include "transport/status_board.h"

namespace strandcast {

/// What a program says of itself in its participant's user data, so that a daemon that starts knows whom it
/// has to hear out: docs/wire.md, "Topics".
struct DdsRole {
  bool is_daemon = false;
  uint32_t groom_id = 0;
  bool claims = false;  ///< a daemon that shares the groom

  bool operator==(const DdsRole&) const = default;
};
std::vector<uint8_t> userDataOf(const DdsRole& role);
/// Nothing where the bytes say no role.
std::optional<DdsRole> roleOf(std::span<const uint8_t> user_data);

/// The other participants of a domain. Participants are found by single datagrams that each of them repeats,
/// long before their readers and writers are. Thread-safe.
class DdsNeighbours final : public eprosima::fastdds::dds::DomainParticipantListener {
 public:
  void on_participant_discovery(eprosima::fastdds::dds::DomainParticipant* participant,
                                eprosima::fastrtps::rtps::ParticipantDiscoveryInfo&& info) override;

  void on_publisher_discovery(eprosima::fastdds::dds::DomainParticipant* participant,
                              eprosima::fastrtps::rtps::WriterDiscoveryInfo&& info) override;

  /// Those that may cast this groom: its daemons, without those that claim it where `own_claims`, and those
  /// that say no role.
  size_t possibleRivals(uint32_t groom_id, bool own_claims) const;
  /// Those that say no role: programs with keys, others' programs, those of before.
  size_t strangers() const;
  /// Whether a daemon of this groom has been known for longer than `finding`; one that shares the groom, and
  /// may stand by, for longer than `claimant`.
  bool hasSilentDaemon(uint32_t groom_id, std::chrono::milliseconds finding,
                       std::chrono::milliseconds claimant) const;
  /// Of the participant that has this writer.
  std::optional<DdsRole> roleOfWriter(const StatusBoard::WriterId& writer) const;
  /// The participants that claim this groom, by GUID prefix, and since when they are known.
  using Prefix = std::array<uint8_t, 12>;
  using Times = std::map<Prefix, std::chrono::steady_clock::time_point>;
  Times claimants(uint32_t groom_id) const;
  /// Whether a daemon of this groom has been known for longer than `time`, none of whose writers is: what it
  /// sends does not get here.
  bool hasUnheardDaemon(uint32_t groom_id, std::chrono::milliseconds time) const;
  /// Of the writer of claims that this participant has; nothing where none was found.
  std::optional<uint32_t> strengthOf(const Prefix& prefix) const;

 private:
  struct Neighbour {
    std::optional<DdsRole> role;
    std::chrono::steady_clock::time_point since = std::chrono::steady_clock::now();
    bool is_heard = false;             ///< a writer of it was found
    std::optional<uint32_t> strength;  ///< of its claims
  };
  mutable std::mutex mutex_;
  std::map<Prefix, Neighbour> known_;
};

/// Of a writer's GUID: what all writers of a participant have in common.
DdsNeighbours::Prefix prefixOf(const StatusBoard::WriterId& writer);

}  // namespace strandcast
