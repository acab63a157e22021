#pragma once

namespace strandcast {

/// Period of a point pendulum of the amplitude `angle` (rad, below pi), in units of that of small swings,
/// 2 pi sqrt(l / g): 1 / agm(1, cos(angle / 2)), Gauss's arithmetic-geometric mean.
double pendulumPeriod(double angle);

}  // namespace strandcast
