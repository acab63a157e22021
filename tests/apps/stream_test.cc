// What programs that draw or record a stream rely on.
#include <gtest/gtest.h>

#include "apps/stream_scene.h"

namespace strandcast {
namespace {

template <class Description>
std::shared_ptr<const Description> described(uint64_t session, uint32_t revision) {
  Description made;
  made.session = session;
  made.revision = revision;
  return std::make_shared<Description>(made);
}

TEST(StreamScene, FitsFramesOfItsDaemonAloneAndOnlyWhole) {
  const auto groom = described<GroomDescription>(11, 2);
  const auto body = described<BodyDescription>(11, 2);
  GuideFrame frame;
  frame.session = 11;
  frame.revision = 2;
  EXPECT_TRUE((StreamScene{groom, body}.fits(frame)));
  EXPECT_FALSE((StreamScene{groom, nullptr}.fits(frame))) << "the body of a daemon started anew is to come";
  EXPECT_FALSE((StreamScene{nullptr, body}.fits(frame)));
  EXPECT_FALSE((StreamScene{groom, described<BodyDescription>(12, 2)}.fits(frame)));
  EXPECT_FALSE((StreamScene{groom, described<BodyDescription>(11, 1)}.fits(frame)));
  frame.session = 12;
  EXPECT_FALSE((StreamScene{groom, body}.fits(frame)));
}

}  // namespace
}  // namespace strandcast
