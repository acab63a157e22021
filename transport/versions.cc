#include "transport/versions.h"

#include <charconv>
#include <system_error>

#include "transport/lcm/lcm_messages.h"
#include "transport/wire_fields.h"

namespace strandcast {
namespace {

/// Fingerprints of the versions before, which had them from `first` to `last`.
struct OldType {
  uint64_t fingerprint;
  int first, last;
};
constexpr OldType kOldStatus{0xef3e4cb5aa11d6fb, 5, 6};
constexpr OldType kOldTypes[] = {
    {0x644935bcf5be764b, 2, 4}, kOldStatus,                   // status_t
    {0x939ad8561956a4a0, 2, 3}, {0xb397e77dc3e6ba5a, 4, 5},   // guide_chunk_t
    {0x161dfb4605380567, 6, 6}, {0x5d852f45c87b1138, 2, 6}};  // guide_chunk_t, reader_t

/// Of groom_id in kOldStatus: behind the fingerprint and 17 numbers of 8 bytes.
constexpr size_t kOldStatusGroom = 8 + 17 * 8;

uint64_t fingerprintOf(std::span<const uint8_t> message) {
  return message.size() < 8 ? 0 : loadBigEndian<uint64_t>(message.data());
}

std::string nameOf(const OtherVersion& other) {
  if (other.first == 0) return "a newer wire version";
  const std::string first = "wire version " + std::to_string(other.first);
  if (other.first == other.last) return first;
  return first + (other.first + 1 == other.last ? " or " : " to ") + std::to_string(other.last);
}

}  // namespace

int versionOfType(std::string_view name) {
  constexpr std::string_view kModule = "strandcast::v";
  if (!name.starts_with(kModule)) return 0;
  name.remove_prefix(kModule.size());
  int version = 0;
  const auto [rest, failure] = std::from_chars(name.data(), name.data() + name.size(), version);
  name.remove_prefix(static_cast<size_t>(rest - name.data()));
  return failure == std::errc() && version > 0 && name.starts_with("::") ? version : 0;
}

std::optional<OtherVersion> versionOfMessage(std::span<const uint8_t> message, bool is_daemon) {
  const uint64_t fingerprint = fingerprintOf(message);
  if (fingerprint == 0 || fingerprint == lcmFingerprint<GuideChunk>() ||
      fingerprint == lcmFingerprint<Status>() || fingerprint == lcmFingerprint<ReaderReport>())
    return std::nullopt;
  for (const OldType& old : kOldTypes)
    if (old.fingerprint == fingerprint) return OtherVersion{is_daemon, old.first, old.last};
  return OtherVersion{is_daemon, 0, 0};
}

bool isOldStatusOf(uint32_t groom_id, std::span<const uint8_t> message) {
  return fingerprintOf(message) == kOldStatus.fingerprint && message.size() >= kOldStatusGroom + 4 &&
         loadBigEndian<uint32_t>(message.data() + kOldStatusGroom) == groom_id;
}

std::string warningOf(const OtherVersion& other, uint32_t groom_id, const std::string& network) {
  const std::string groom = "groom " + std::to_string(groom_id) + " on " + network,
                    own = std::to_string(kWireVersion) + ": update the older one";
  return other.is_daemon ? "a daemon of " + nameOf(other) + " casts " + groom + "; this program speaks " + own
                         : "a program of " + nameOf(other) + " wants " + groom +
                               " and gets nothing: this daemon speaks " + own;
}

}  // namespace strandcast
