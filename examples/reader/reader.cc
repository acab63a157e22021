// A complete client: takes every frame of a daemon and prints it, across ends and starts of the daemon.
#include <chrono>
#include <cstdio>
#include <memory>
#include <stdexcept>
#include <string>

#include "core/error.h"
#include "transport/dds.h"

using namespace std::chrono_literals;

namespace {

void printFrame(const strandcast::GuideFrame& frame, const strandcast::ReceiveStatistics& statistics) {
  strandcast::Box box;
  for (const strandcast::Vec3& position : frame.positions) box.extend(position);
  std::printf("frame %llu at %.3f s: x %.3f to %.3f, y %.3f to %.3f, z %.3f to %.3f m; %llu lost, %.2f ms\n",
              static_cast<unsigned long long>(frame.frame), frame.simulation_time,
              static_cast<double>(box.min().x()), static_cast<double>(box.max().x()),
              static_cast<double>(box.min().y()), static_cast<double>(box.max().y()),
              static_cast<double>(box.min().z()), static_cast<double>(box.max().z()),
              static_cast<unsigned long long>(statistics.frames_lost), statistics.latency_ms_p50);
}

void printGroom(const strandcast::GroomDescription& groom) {
  std::printf("groom '%s': %zu strands, %zu vertices; strand 0 has vertices 0 to %u\n", groom.name.c_str(),
              groom.guides.strands(), groom.guides.vertices(), groom.guides.offsets[1] - 1);
}

}  // namespace

int main(int argc, char** argv) {
  try {
    if (argc > 3 || (argc > 1 && std::string(argv[1]) == "--help")) {
      std::puts(
          "usage: reader [DOMAIN [FRAMES]]\n"
          "Reads groom 1 of a DDS domain (default 0), until interrupted or for FRAMES frames.");
      return argc > 3 ? 2 : 0;
    }
    strandcast::DdsOptions options;
    options.domain = argc > 1 ? std::stoi(argv[1]) : 0;
    const int frames = argc > 2 ? std::stoi(argv[2]) : 0;

    // The subscriber receives in its own thread from now on.
    const std::unique_ptr<strandcast::Subscriber> subscriber = strandcast::makeDdsSubscriber(options);
    std::shared_ptr<const strandcast::GroomDescription> groom;
    std::shared_ptr<const strandcast::GuideFrame> last;  // returned objects are immutable
    bool was_there = false;
    for (int taken = 0; frames == 0 || taken < frames;) {
      const auto frame = subscriber->waitForNext(last.get(), 500ms);
      const bool is_there = subscriber->status().has_value();
      if (is_there != was_there) std::puts(is_there ? "a daemon is present" : "no daemon is present");
      was_there = is_there;
      if (!frame) continue;
      last = frame;
      if (const auto newest = subscriber->groom(); newest != groom) printGroom(*(groom = newest));
      // The groom of a new daemon may arrive before its first frame.
      if (frame->session != groom->session || frame->revision != groom->revision) continue;
      if (taken++ % 60 == 0) printFrame(*frame, subscriber->statistics());
    }
  } catch (const strandcast::Error& error) {
    std::fprintf(stderr, "error: %s\n", error.what());
    return 2;
  } catch (const std::logic_error&) {
    std::fprintf(stderr, "error: not a number; see reader --help\n");
    return 2;
  }
}
