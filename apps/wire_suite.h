#pragma once
#include "validation/suite.h"

namespace strandcast {

/// "wire": simulated hair sent and received on this machine, for each transport, codec, number of guides and
/// rate. Documented promises have a limit; other quantities have an infinite limit and are reported only.
/// Ignores the laboratory's backend. Other load on the machine affects the results.
const Suite& wireSuite();

}  // namespace strandcast
