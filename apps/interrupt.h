#pragma once
#include <atomic>

namespace strandcast {

/// Set by SIGINT and SIGTERM instead of ending the process; loops poll it and end cleanly.
extern std::atomic<bool> g_interrupted;
/// Installs the signal handlers.
void catchInterrupts();

}  // namespace strandcast
