#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "core/strand_set.h"

namespace strandcast {

/// Chooses, for each hair, the guides that it follows (groom/bound_growth.h) and their weights.
///
/// Candidates are the 12 guides with the nearest roots, of the hair's part where both sets have parts, which
/// must number them alike, and at least 3 guides are of that part. The distance d of hair and guide is the
/// RMS distance of their points at equal arc lengths: nine, from the root to the tip, or to the guide's tip
/// where the hair is longer. The three least distances are taken, without guides that part from the first
/// (isParting). Guides of less than a third of the hair's length are taken only where all candidates are that
/// short: the codec's noise on a short guide turns a long hair visibly. Weights are proportional to 1 / (d^2
/// + (0.1 mm)^2). A hair that equals a candidate follows it alone.
///
/// Returns one binding per hair; the result is the same on all machines. Memory: that of the guides' roots.
/// Precondition: checkStrandSet() accepts both sets, and every strand has a vertex. Throws Error where there
/// are hairs but no guides.
std::vector<HairBinding> bindHairs(const StrandSet& hairs, const StrandSet& guides);

/// Indices of the hairs in the order of their first guides, else as they stand. The hair codec
/// (transport/codec/hair_codec.h) takes the fewest bytes for this order.
std::vector<uint32_t> orderByGuide(std::span<const HairBinding> bindings);

}  // namespace strandcast
