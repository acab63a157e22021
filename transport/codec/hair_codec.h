#pragma once
#include <string>
#include <vector>

#include "transport/chunks.h"
#include "transport/codec/codec.h"
#include "transport/codec/strand_coder.h"

namespace strandcast {

/// Bound hairs in chunks; docs/wire.md, "Hairs", has the format. A chunk decodes alone, given the guides at
/// rest. Vertices are steps on a grid from a prediction: the hair's first guide, turned and scaled as the
/// hair is so far.

inline constexpr uint32_t kMaxHairs = 4'000'000;                        ///< of a groom
inline constexpr float kDefaultHairError = CodecOptions().hair_error;   // m
inline constexpr uint32_t kMinVerticesPerHair = 2;                      ///< at most kMaxWireVertices
inline constexpr float kMinHairStep = 1e-6f, kMaxHairStep = 1e-3f;      // m, of HairChunk::step
inline constexpr float kMinRadiusStep = 1e-9f, kMaxRadiusStep = 1e-5f;  // m

/// Throws Error, naming `where`, on hairs that a receiver would refuse: arrays that do not fit each other,
/// numbers that are not finite, hairs of 1 or more than kMaxWireVertices vertices, radii above kThickestHair,
/// bindings to guides that do not exist or with weights above 1, no hair or more than kMaxHairs.
void checkHairs(const HairDescription& hairs, const StrandSet& guides, const std::string& where);

/// Encodes hairs into chunks of at most kMaxChunkBytes, in their order; that of orderByGuide()
/// (groom/hair_binding.h) takes the fewest bytes. Each decoded vertex is within `max_error` (m, kMinHairError
/// to kMaxHairError) of its place. Radii are exact to 10 nm or 1/65,000 of the largest, uvs to 1/130,000 of
/// the range of all. Every `coder` writes the same bytes.
///
/// Precondition: checkHairs() accepts the hairs, checkAnnouncement() the guides. Throws Error, naming
/// HairDescription::source, where a hair lies too far from its guide or from the origin for that error, or
/// the hairs need more than kMaxChunks.
std::vector<HairChunk> encodeHairs(const HairDescription& hairs, const StrandSet& guides, float max_error,
                                   const StrandCoder& coder = strandCoder());

/// Whether the chunk has an encoding that is known here, arrays and steps of their ranges, and counts that
/// can be those of hairs.
bool isSoundHead(const HairChunk& chunk);

/// Appends the hairs of a chunk to `hairs`, which is empty or has hairs of chunks with the same `arrays`;
/// sets nothing else. Nothing in the chunk is trusted: memory is bounded by the bytes of the payload. False
/// on a damaged chunk; the content of `hairs` is unspecified then. Precondition: an assembler made `guides`,
/// or checkAnnouncement() accepted them.
bool decodeHairs(const HairChunk& chunk, const StrandSet& guides, HairDescription& hairs,
                 const StrandCoder& coder = strandCoder());

}  // namespace strandcast
