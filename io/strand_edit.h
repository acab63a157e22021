#pragma once
#include <cstdint>
#include <span>
#include <string>

#include "core/strand_set.h"
#include "io/file_report.h"

namespace strandcast {

/// Appends chosen vertices of strand `s` of `from` as a new strand of `to`, with their pins and radii, and
/// what appendStrandValues() appends. `vertices`: indices within the strand, in any order. `to` must be empty
/// or hold strands appended from the same set.
void appendStrand(StrandSet& to, const StrandSet& from, size_t s, std::span<const uint32_t> vertices);
/// As above, with all vertices of the strand.
void appendStrand(StrandSet& to, const StrandSet& from, size_t s);
/// Appends the values per strand of strand `s` of `from` alone: UV, part, id, guide mark, group and colour.
/// For those who make the vertices of the strand anew.
void appendStrandValues(StrandSet& to, const StrandSet& from, size_t s);

/// Median length of the strands that have two or more vertices; 0 when there are none.
float medianLength(const StrandSet& strands);

/// Removes strands with a position that is not finite, and reports their number. Throws Error, which names
/// `where`, when none is left.
void removeNonFinite(StrandSet& strands, FileReport& report, const std::string& where);

/// Strands shorter than this share of the median length are dropped.
constexpr float kShortestOfMedian = 0.01f;

}  // namespace strandcast
