// The suite "poses": a walking character that another process moves over a bad link, and the cases.
#pragma once
#include <functional>

#include "validation/suite.h"

namespace CLI {
class App;
}

namespace strandcast {

/// Duration of a row unless asked for, s.
inline constexpr double kPoseTrialSeconds = 20;

/// "poses": for each transport and rate of the sender, a daemon casts the walker's hair for `seconds`, 4 or
/// more. Of the messages 1 % are dropped, and the others held back by up to 50 ms. The sender is killed and
/// replaced twice, with silence of a twentieth and a fifth of the duration, at most 3 s and 12 s. The run is
/// then simulated again from its recording, and from the sender's own motion. Ignores the laboratory's
/// backend. Other load on the machine affects latencies.
Suite poseSuite(double seconds = kPoseTrialSeconds);

/// Declares the verb `pose-sender`, the child process of the suite. It prints "ready" once it has the groom.
/// From then on, each second, it prints a line of JSON: for each sample that came back in a frame for the
/// first time, its age in ms when the frame was decoded, by the sender's clock. It ends with its input.
std::function<int()> addPoseSender(CLI::App& app);

}  // namespace strandcast
