#pragma once
#include "idl/strandcast.h"
#include "transport/chunks.h"

namespace strandcast {

/// Between the project's structs and the generated types. The large arrays are exchanged (swapped), not
/// copied: both sides keep their memory for the next chunk. `fromWire` takes what was received unchecked;
/// strings that are longer than kMaxTextBytes are cut.
void toWire(GroomChunk& chunk, v3::GroomChunk& wire);
void fromWire(v3::GroomChunk& wire, GroomChunk& chunk);
void toWire(BodyChunk& chunk, v3::BodyChunk& wire);
void fromWire(v3::BodyChunk& wire, BodyChunk& chunk);
void toWire(GuideChunk& chunk, v3::GuideChunk& wire);
void fromWire(v3::GuideChunk& wire, GuideChunk& chunk);
void toWire(const Command& command, v3::Command& wire);
void fromWire(const v3::Command& wire, Command& command);
void toWire(const Status& status, v3::Status& wire);
void fromWire(const v3::Status& wire, Status& status);

}  // namespace strandcast
