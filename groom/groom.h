#pragma once
#include <string>
#include <vector>

#include "core/strand_set.h"

namespace strandcast {

/// What loading and cleaning a groom found. Counts of strands unless said.
struct GroomReport {
  size_t strands_read = 0;
  size_t dropped_short = 0;  ///< fewer than 2 distinct vertices, or shorter than 1 % of the median length
  size_t duplicate_vertices = 0;  ///< vertices of kept strands that were too near their neighbour, removed
  size_t reversed = 0;            ///< strands whose tip was nearer the scalp than the root, turned round
  size_t both_ends_pinned = 0;    ///< kept strands whose tip is pinned too
  size_t resampled = 0;           ///< strands of more than 128 vertices, evened down to 128
  float unit_meters =
      0;  ///< metres per unit of the files, given or guessed; a body of the same origin has it too
  bool is_unit_guessed = false;       ///< it is neither given nor said by the files
  std::vector<std::string> warnings;  ///< one line each, e.g. that the unit was guessed, and from what
  std::vector<std::string> left_out;  ///< what else the file has (FileReport); of several files a
                                      ///< line each, "NAME: A, B"

  std::vector<std::string> lines() const;  ///< what to tell of it but for warnings
};

/// Rest strands in metres, Y up, with what was found while loading them.
struct Groom {
  std::string name;  ///< of files: their names without folder and extension, joined by +
  StrandSet strands;
  GroomReport report;
};

/// What `strandcast info` prints of a groom. All zero, and an empty box, for a set without strands.
struct GroomSummary {
  size_t strands = 0, vertices = 0;
  size_t min_vertices = 0, max_vertices = 0;  ///< of one strand
  size_t degenerate_strands = 0;              ///< those that cleaning drops for being short (GroomReport)
  float min_length = 0, median_length = 0, max_length = 0;  ///< m, along the strand
  Box bounds;                                               ///< m
};
/// Of strands in any unit: lengths and bounds come in the unit of the positions.
GroomSummary summarize(const StrandSet& strands);

}  // namespace strandcast
