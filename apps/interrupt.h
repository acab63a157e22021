#pragma once
#include <atomic>

namespace strandcast {

/// SIGINT and SIGTERM set this instead of killing the program; loops look at it and end cleanly.
extern std::atomic<bool> g_interrupted;
void catchInterrupts();

}  // namespace strandcast
