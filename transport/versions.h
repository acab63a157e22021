// Programs of other versions of the wire: how they are recognised, and what is said of them.
#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "transport/messages.h"

namespace strandcast {

/// Version that the name of a DDS type states, "strandcast::v7::Status"; 0 where it states none.
int versionOfType(std::string_view name);

/// Version of the sender of an LCM message on the channel of guides, statuses or readers, by its fingerprint;
/// nothing where this is a message of the present version or of nobody. Unknown fingerprints count as newer.
std::optional<OtherVersion> versionOfMessage(std::span<const uint8_t> message, bool is_daemon);

/// Whether a status is of wire version 5 or 6 and of this groom: the program cannot read the rest of it.
bool isOldStatusOf(uint32_t groom_id, std::span<const uint8_t> message);

/// "a daemon of wire version 6 casts groom 1 on DDS domain 0; this program speaks 7: update the older one",
/// or that a reader gets nothing.
std::string warningOf(const OtherVersion& other, uint32_t groom_id, const std::string& network);

}  // namespace strandcast
