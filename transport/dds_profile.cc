#include <array>

#include "core/error.h"
#include "transport/dds.h"

namespace strandcast {
namespace {

constexpr std::array<DdsProfileInfo, 3> kProfiles = {{
    {DdsProfile::kReliableLan, "reliable-lan", "UDP, what is lost is repaired"},
    {DdsProfile::kBestEffort, "best-effort",
     "UDP; a reader's frames are not repaired, their lost strands are concealed: least delay"},
    {DdsProfile::kLocal, "local", "shared memory within one machine, UDP to others"},
}};

}  // namespace

std::span<const DdsProfileInfo> ddsProfileList() { return kProfiles; }

DdsProfile ddsProfileNamed(const std::string& name, const std::string& where) {
  std::string names;
  for (const DdsProfileInfo& info : kProfiles) {
    if (name == info.name) return info.profile;
    names += (names.empty() ? "" : ", ") + std::string(info.name);
  }
  throw Error("unknown profile '" + name + "'", where, "choose one of " + names);
}

}  // namespace strandcast
