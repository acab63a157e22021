#include "transport/chunks.h"
#include "transport/dds.h"
#include "transport/dds_participant.h"
#include "transport/dds_type.h"

namespace strandcast {
namespace {

/// Poses are small, and by UDP they reach daemons of other users at once.
DdsNetwork overUdp(const DdsOptions& options) {
  DdsOptions small = options;
  small.frames = false;  // shared memory of another user does not matter
  DdsNetwork network(small);
  network.uses_shared_memory = false;
  return network;
}

class DdsPoseSender final : public PoseSender {
 public:
  DdsPoseSender(const DdsOptions& options, const std::vector<uint32_t>& further_grooms)
      : PoseSender(further_grooms.empty() ? options.groom_id : 0, 1),
        participant_(overUdp(options), options.groom_id, DdsRole{false, options.groom_id, false}, nullptr,
                     further_grooms),
        writer_(*participant_.createWriter(kPoseTopic, new WireType<PoseSamples>, nullptr)) {}

 private:
  void write(PoseSamples& message) override { writer_.write(&message); }

  DdsParticipant participant_;
  eprosima::fastdds::dds::DataWriter& writer_;
};

}  // namespace

std::unique_ptr<PoseSender> makeDdsPoseSender(const DdsOptions& options,
                                              const std::vector<uint32_t>& further_grooms) {
  checkGroomId(options.groom_id, "DDS options");
  for (const uint32_t groom_id : further_grooms) checkGroomId(groom_id, "DDS options");
  return std::make_unique<DdsPoseSender>(options, further_grooms);
}

}  // namespace strandcast
