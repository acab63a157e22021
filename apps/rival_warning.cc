#include "apps/rival_warning.h"

#include <spdlog/spdlog.h>

namespace strandcast {

void RivalWarning::look(const Publisher& publisher) {
  const std::optional<Rival> rival = publisher.rival();
  if (!rival || !rival->casts || rival->session == warned_) return;
  warned_ = rival->session;
  spdlog::warn(
      "another daemon, session {:016x}, casts groom {} too, and it is left to chance whom a "
      "reader sees: stop one of them",
      warned_, groom_id_);
}

}  // namespace strandcast
