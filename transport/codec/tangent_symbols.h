#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "transport/codec/guide_symbols.h"

namespace strandcast {

/// Writes and reads the symbols of a chunk in Encoding::kTangent: small signed numbers whose size is much
/// like that of their neighbours', along the strand and in the frame before. Each has a Rice code
/// (bit_stream.h) whose parameter follows from these, so that a chunk needs no tables and decodes alone.

/// Of an edge, for the next one and the next frame: |u| + |v| of its symbols, at most 65535.
using TangentSizes = std::vector<uint16_t>;

/// Appends to `bytes`. `strand_ends` as SymbolPrediction's; `before` are the sizes of the frame that this one
/// builds on, empty where it stands alone; `sizes` are set.
void packTangents(const GuideSymbols& symbols, std::span<const uint32_t> strand_ends,
                  const TangentSizes& before, TangentSizes& sizes, std::vector<uint8_t>& bytes);
/// Into `symbols`, whose planes have the lengths that are expected. False on bytes that are damaged, too few
/// or too many; `symbols` and `sizes` are arbitrary then.
bool unpackTangents(std::span<const uint8_t> bytes, std::span<const uint32_t> strand_ends,
                    const TangentSizes& before, TangentSizes& sizes, GuideSymbols& symbols);

}  // namespace strandcast
