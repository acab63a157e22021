#pragma once

namespace strandcast {

/// Sag of a chain hung between two points of equal height, in units of its length; `span` is their distance
/// in the same unit, between 0 and 1.
double catenarySag(double span);

}  // namespace strandcast
