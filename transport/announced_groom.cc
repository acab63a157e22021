#include "transport/announced_groom.h"

namespace strandcast {

AnnouncedGroom::Chunks AnnouncedGroom::chunksOf(const GroomDescription& groom,
                                                const BodyDescription& body) const {
  checkAnnouncement(groom, body, "groom " + groom.name);
  GroomDescription own_groom = groom;
  own_groom.groom_id = groom_id_;
  own_groom.session = session_;
  checkSuccession(accepted_ ? &*accepted_ : nullptr, own_groom);
  BodyDescription own_body = body;
  own_body.groom_id = groom_id_;
  own_body.session = session_;
  own_body.revision = groom.revision;
  return {splitGroom(own_groom), splitBody(own_body)};
}

void AnnouncedGroom::accept(const GroomDescription& groom) {
  encoder_.setGroom(groom.guides);
  vertices_ = groom.guides.vertices();
  accepted_.emplace();
  accepted_->session = session_;
  accepted_->revision = groom.revision;
}

void AnnouncedGroom::divide(const GuideFrame& frame, const std::function<void(GuideChunk&)>& send) {
  if (!accepted_ || frame.revision != accepted_->revision || frame.positions.size() != vertices_) return;
  encoder_.encodeAll(frame, [&](GuideChunk& chunk) {
    chunk.groom_id = groom_id_;
    chunk.session = session_;
    send(chunk);
  });
}

}  // namespace strandcast
