// The engine's side of live poses: plays a BVH clip, sends its head and joints to a daemon, and prints how
// old the poses are when the hair that they moved has arrived here.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "core/error.h"
#include "transport/dds.h"
#include "transport/lcm.h"
#include "transport/pose_sender.h"

using namespace std::chrono_literals;
using strandcast::Pose;
using strandcast::Quat;
using strandcast::Vec3;

namespace {

struct Joint {
  std::string name;  // empty: the end of a chain
  int parent = -1;
  Vec3 offset = Vec3::Zero();         // from the parent at rest, in the clip's units
  std::vector<std::string> channels;  // "Xposition", "Zrotation", in the order of the file
};

/// A clip in its own units. The engine of a real program has all of this.
struct Clip {
  std::vector<Joint> joints;  // parents first
  std::vector<std::vector<float>> frames;
  double frame_time = 0;  // s

  /// World poses of all joints at a frame.
  std::vector<Pose> at(size_t frame) const {
    std::vector<Pose> poses;
    size_t next = 0;
    for (const Joint& joint : joints) {
      Pose local{joint.offset, Quat::Identity()};
      for (const std::string& channel : joint.channels) {
        const float value = frames[frame][next++];
        const int axis = channel[0] - 'X';
        if (channel.substr(1) == "position")
          local.position[axis] = value;
        else
          local.rotation = local.rotation * Quat(Eigen::AngleAxisf(value * 0.017453293f, Vec3::Unit(axis)));
      }
      poses.push_back(joint.parent < 0 ? local : poses[static_cast<size_t>(joint.parent)] * local);
    }
    return poses;
  }
  /// Positions of all joints at rest: nothing is turned, and the root stands where the first frame has it.
  std::vector<Vec3> rest() const {
    std::vector<Vec3> places;
    for (const Joint& joint : joints)
      places.push_back(joint.parent < 0 ? at(0)[0].position
                                        : Vec3(places[static_cast<size_t>(joint.parent)] + joint.offset));
    return places;
  }
};

Clip readClip(const std::string& name) {
  std::ifstream file(name);
  if (!file) throw strandcast::Error("the clip cannot be read", name, "name a .bvh file");
  Clip clip;
  std::vector<int> open;  // joints whose braces are open
  size_t channels = 0, frames = 0;
  for (std::string word; frames == 0 && file >> word;) {
    if (word == "ROOT" || word == "JOINT" || word == "End") {
      Joint joint;
      file >> joint.name;
      if (word == "End") joint.name.clear();  // "End Site"
      joint.parent = open.empty() ? -1 : open.back();
      clip.joints.push_back(joint);
    } else if (word == "{") {
      open.push_back(static_cast<int>(clip.joints.size()) - 1);
    } else if (word == "}" && !open.empty()) {
      open.pop_back();
    } else if (word == "OFFSET" && !clip.joints.empty()) {
      for (int axis = 0; axis < 3; ++axis) file >> clip.joints.back().offset[axis];
    } else if (word == "CHANNELS" && !clip.joints.empty()) {
      size_t count = 0;
      file >> count;
      for (; file && count > 0; --count, ++channels) {
        file >> word;
        if (word.size() < 2 || word[0] < 'X' || word[0] > 'Z')
          throw strandcast::Error("a channel is unknown: " + word, name, "");
        clip.joints.back().channels.push_back(word);
      }
    } else if (word == "Frames:") {
      file >> frames >> word >> word >> clip.frame_time;  // "Frame Time: 0.0333333"
    }
  }
  for (std::vector<float> values(channels); clip.frames.size() < frames; clip.frames.push_back(values))
    for (float& value : values)
      if (!(file >> value)) throw strandcast::Error("the clip ends early", name, "");
  if (clip.frames.empty() || clip.joints.empty() || !(clip.frame_time > 0))
    throw strandcast::Error("the clip has no motion", name, "name a .bvh file");
  return clip;
}

/// Metres per unit with which the skeleton is about as tall as a person.
float unitOf(const std::vector<Vec3>& rest) {
  strandcast::Box box;
  for (const Vec3& place : rest) box.extend(Eigen::Vector3f(place));
  const float height = box.sizes().maxCoeff();
  const auto far = [height](float unit) { return std::abs(std::log(height * unit / 1.7f)); };
  return std::min({1.0f, 0.1f, 0.01f, 0.0254f, 0.001f}, [&](float a, float b) { return far(a) < far(b); });
}

uint64_t nanoseconds(std::chrono::steady_clock::duration time) {
  return static_cast<uint64_t>(std::chrono::nanoseconds(time).count());
}

void printAges(std::vector<double>& ages) {
  if (ages.empty()) {
    std::puts("no hair with these poses has come");
    return;
  }
  std::sort(ages.begin(), ages.end());
  const auto share = [&](double of) {
    return ages[static_cast<size_t>(of * static_cast<double>(ages.size() - 1))];
  };
  std::printf("%zu frames: poses are %.1f ms old in the median, %.1f ms at p99, when their hair is here\n",
              ages.size(), share(0.5), share(0.99));
  std::fflush(stdout);
  ages.clear();
}

}  // namespace

int main(int argc, char** argv) {
  try {
    if (argc < 2 || argc > 5 || std::string(argv[1]) == "--help") {
      std::puts(
          "usage: poser CLIP.bvh [dds|lcm [DOMAIN [SECONDS]]]\n"
          "Moves the head and joints of groom 1 of a domain (default 0), until interrupted or for SECONDS. "
          "A\n"
          "skinned body must have the clip's skeleton; without one the head alone moves.");
      return argc == 2 ? 0 : 2;
    }
    const Clip clip = readClip(argv[1]);
    const bool over_lcm = argc > 2 && std::string(argv[2]) == "lcm";
    const int domain = argc > 3 ? std::stoi(argv[3]) : 0;
    const double seconds = argc > 4 ? std::stod(argv[4]) : 0;
    strandcast::DdsOptions dds;
    dds.domain = domain;
    strandcast::LcmOptions lcm;
    lcm.url = over_lcm ? strandcast::lcmUrl(domain) : "";
    const auto subscriber =
        over_lcm ? strandcast::makeLcmSubscriber(lcm) : strandcast::makeDdsSubscriber(dds);
    const auto sender = over_lcm ? strandcast::makeLcmPoseSender(lcm) : strandcast::makeDdsPoseSender(dds);
    while (!subscriber->waitForGroom(5s)) {
      std::printf("no daemon casts groom 1 there: strandcastd --transport %s --domain %d\n",
                  over_lcm ? "lcm" : "dds", domain);
      std::fflush(stdout);
    }

    // The head turns about the middle of the hair's roots: a groom does not say where its neck is.
    const strandcast::StrandSet& guides = subscriber->groom()->guides;
    Vec3 middle = Vec3::Zero();
    for (size_t s = 0; s < guides.strands(); ++s)
      middle += guides.positions[guides.offsets[s]] / static_cast<float>(guides.strands());

    std::vector<std::string> names{"head"};
    size_t head = 0;
    for (size_t j = 0; j < clip.joints.size(); ++j) {
      const std::string& name = clip.joints[j].name;
      if (!name.empty()) names.push_back("joint:" + name);
      if (head == 0 && (name.find("head") != std::string::npos || name.find("Head") != std::string::npos))
        head = j;
    }
    sender->setNames(names);
    const std::vector<Vec3> rest = clip.rest();
    const float unit = unitOf(rest);
    const Pose first = clip.at(0)[head];
    const auto posesAt = [&](size_t frame) {
      const std::vector<Pose> world = clip.at(frame);
      const Quat turn = (world[head].rotation * first.rotation.conjugate()).normalized();
      std::vector<Pose> motions{
          {middle - turn * middle + unit * (world[head].position - first.position), turn}};
      const Vec3 stands(rest[0].x(), 0, rest[0].z());  // the clip may begin anywhere
      for (size_t j = 0; j < world.size(); ++j) {
        if (clip.joints[j].name.empty()) continue;
        const Quat& rotation = world[j].rotation;
        motions.push_back({unit * (world[j].position - stands - rotation * (rest[j] - stands)), rotation});
      }
      return motions;
    };

    const uint64_t period = nanoseconds(
        std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::duration<double>(clip.frame_time)));
    const auto start = std::chrono::steady_clock::now();
    std::vector<double> ages;  // ms
    std::shared_ptr<const strandcast::GuideFrame> last;
    auto told = start;
    for (uint64_t number = 0; seconds == 0 || number * period < static_cast<uint64_t>(1e9 * seconds);
         ++number) {
      const auto due = start + std::chrono::nanoseconds(number * period);
      // While it waits, an engine would draw the hair that comes.
      for (auto now = std::chrono::steady_clock::now(); now < due; now = std::chrono::steady_clock::now()) {
        const auto wait = std::chrono::ceil<std::chrono::milliseconds>(due - now);
        const auto frame =
            subscriber->waitForNext(last.get(), std::min<std::chrono::milliseconds>(wait, 5ms));
        if (!frame) continue;
        last = frame;
        if (frame->pose_source == sender->source())
          ages.push_back(1e-6 * static_cast<double>(frame->arrival_time - frame->pose_time));
      }
      const size_t shown = number % clip.frames.size();
      if (shown == 0) sender->cut();  // from the clip's end to its start
      // The time that the sample shows, by a clock that runs evenly: here that of arrival_time
      sender->send(nanoseconds(due.time_since_epoch()), posesAt(shown));
      if (due - told < 5s) continue;
      told = due;
      printAges(ages);
    }
    printAges(ages);
  } catch (const strandcast::Error& error) {
    std::fprintf(stderr, "error: %s\n", error.what());
    return 2;
  } catch (const std::logic_error&) {
    std::fprintf(stderr, "error: not a number; see poser --help\n");
    return 2;
  }
}
