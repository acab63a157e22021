#pragma once
#include <sys/types.h>

#include <filesystem>

namespace strandcast {

/// Whether a program of another user than `own` takes part in this DDS domain through shared memory. The
/// segments of each are its user's alone: Fast DDS 2.9.1 hears nothing of the others there, and a participant
/// that is sent something by such a one is given nothing more by anybody. `folder`: where segments are.
bool anotherUserSharesMemory(int domain, uid_t own, const std::filesystem::path& folder = "/dev/shm");

}  // namespace strandcast
