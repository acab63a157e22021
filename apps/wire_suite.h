#pragma once
#include "validation/suite.h"

namespace strandcast {

/// "wire": simulated hair cast and received on this machine, for each transport, codec, number of guides and
/// rate. What is promised has a limit; where nothing is, the limit is infinite and the number is told. Does
/// not look at the laboratory's backend. Cases stand beside what else runs on the machine.
const Suite& wireSuite();

}  // namespace strandcast
