#pragma once
#include <cstdint>
#include <span>
#include <string>

#include "core/strand_set.h"
#include "groom/file_report.h"

namespace strandcast {

/// Appends the chosen vertices (indices within the strand, any order) of strand `s` of `from`, with their
/// pins and radii, and the strand's UV and part. `to` starts empty and takes strands of one set only.
void appendStrand(StrandSet& to, const StrandSet& from, size_t s, std::span<const uint32_t> vertices);
/// The same with all of the strand's vertices.
void appendStrand(StrandSet& to, const StrandSet& from, size_t s);

/// The median of the strands' lengths, of those with two or more vertices; 0 when there are none.
float medianLength(const StrandSet& strands);

/// Leaves out strands with a position that is not finite, and tells `report` how many. Throws Error, which
/// names `where`, when none is left.
void leaveOutNotFinite(StrandSet& strands, FileReport& report, const std::string& where);

/// Strands shorter than this part of the median length are no hair.
constexpr float kShortestOfMedian = 0.01f;

}  // namespace strandcast
