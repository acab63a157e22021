#include <utility>

#include "transport/chunks.h"
#include "transport/lcm/lcm_ends.h"
#include "transport/lcm/lcm_link.h"
#include "transport/lcm/lcm_messages.h"

namespace strandcast {
namespace {

/// In each message: a sample is lost where three messages in a row are.
constexpr size_t kSamples = 3;

class LcmPoseSender final : public PoseSender {
 public:
  LcmPoseSender(std::shared_ptr<MessageLink> link, std::vector<std::string> channels, uint32_t groom_id)
      : PoseSender(groom_id, kSamples), link_(std::move(link)), channels_(std::move(channels)) {}

 private:
  void write(PoseSamples& message) override {
    toBytes(message, bytes_);
    for (const std::string& channel : channels_) link_->send(channel, bytes_);
  }

  const std::shared_ptr<MessageLink> link_;
  const std::vector<std::string> channels_;
  std::vector<uint8_t> bytes_;
};

}  // namespace

std::unique_ptr<PoseSender> makeLcmPoseSender(std::shared_ptr<MessageLink> link, const LcmOptions& options,
                                              const std::vector<uint32_t>& further_grooms) {
  std::vector<std::string> channels;
  const auto add = [&](uint32_t groom_id) {
    checkGroomId(groom_id, "LCM options");
    channels.push_back(LcmChannels::poseOf(groom_id));
  };
  add(options.groom_id);
  for (const uint32_t groom_id : further_grooms) add(groom_id);
  return std::make_unique<LcmPoseSender>(std::move(link), std::move(channels),
                                         further_grooms.empty() ? options.groom_id : 0);
}

std::unique_ptr<PoseSender> makeLcmPoseSender(const LcmOptions& options,
                                              const std::vector<uint32_t>& further_grooms) {
  checkOneEnd(options);
  return makeLcmPoseSender(std::make_shared<LcmLink>(options.url), options, further_grooms);
}

}  // namespace strandcast
