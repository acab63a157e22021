#include <array>

#include "core/name_lookup.h"
#include "transport/dds.h"

namespace strandcast {
namespace {

constexpr std::array<DdsProfileInfo, 4> kProfiles = {{
    {DdsProfile::kReliableLan, "reliable-lan", "UDP, what is lost is repaired"},
    {DdsProfile::kBestEffort, "best-effort",
     "UDP; a reader's frames are not repaired, their lost strands are concealed: least delay"},
    {DdsProfile::kLocal, "local", "shared memory within one machine, UDP to others"},
    {DdsProfile::kSecure, "secure",
     "UDP, encrypted, among programs that have --keys and do what these permit; others hear nothing"},
}};

}  // namespace

std::span<const DdsProfileInfo> ddsProfileList() { return kProfiles; }

DdsProfile ddsProfileNamed(const std::string& name, const std::string& where) {
  return namedEntry(kProfiles, "profile", name, where).profile;
}

}  // namespace strandcast
