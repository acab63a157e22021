#pragma once
#include <cstdint>
#include <string>

namespace strandcast {

/// The channels of strandcast.lcm.
struct LcmChannels {
  explicit LcmChannels(uint32_t groom_id)
      : groom("STRANDCAST_GROOM_" + std::to_string(groom_id)),
        bodies("STRANDCAST_BODIES_" + std::to_string(groom_id)),
        colliders("STRANDCAST_COLLIDERS_" + std::to_string(groom_id)),
        guides("STRANDCAST_GUIDES_" + std::to_string(groom_id)),
        command("STRANDCAST_COMMAND_" + std::to_string(groom_id)),
        reader("STRANDCAST_READER_" + std::to_string(groom_id)) {}
  const std::string groom, bodies, colliders, guides, command, reader;
  const std::string status = "STRANDCAST_STATUS";
};

}  // namespace strandcast
