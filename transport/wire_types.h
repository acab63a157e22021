#pragma once
#include "idl/strandcast.h"
#include "transport/chunks.h"
#include "transport/show.h"

namespace strandcast {

/// Convert between the project's structs and the generated types. Large arrays are swapped, not copied, so
/// that both sides reuse their memory. `fromWire` does not check what was received; it cuts strings to
/// kMaxTextBytes.
void toWire(GroomChunk& chunk, v6::GroomChunk& wire);
void fromWire(v6::GroomChunk& wire, GroomChunk& chunk);
void toWire(BodyChunk& chunk, v6::BodyChunk& wire);
void fromWire(v6::BodyChunk& wire, BodyChunk& chunk);
void toWire(ColliderChunk& chunk, v6::ColliderChunk& wire);
void fromWire(v6::ColliderChunk& wire, ColliderChunk& chunk);
void toWire(GuideChunk& chunk, v6::GuideChunk& wire);
void fromWire(v6::GuideChunk& wire, GuideChunk& chunk);
void toWire(const Command& command, v6::Command& wire);
void fromWire(const v6::Command& wire, Command& command);
void toWire(ShowChunk& chunk, v6::ShowChunk& wire);
void fromWire(v6::ShowChunk& wire, ShowChunk& chunk);
void toWire(const Status& status, v6::Status& wire);
void fromWire(const v6::Status& wire, Status& status);

}  // namespace strandcast
