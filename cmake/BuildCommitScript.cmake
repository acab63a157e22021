# Writes the source file OUT with the git commit of ROOT, unless OUT has it already. See BuildCommit.cmake.
execute_process(COMMAND git -C ${ROOT} describe --always --abbrev=7 --dirty=+ --exclude=*
  OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
if(failed)
  set(commit unknown)
endif()
file(CONFIGURE OUTPUT ${OUT} @ONLY CONTENT [[
#include "bench/machine.h"

namespace strandcast {
std::string buildCommit() { return "@commit@"; }
}  // namespace strandcast
]])
