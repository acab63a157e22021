# Installs the client from the build tree BUILD into the empty folder SCRATCH, and builds and runs EXAMPLE with it.
cmake_minimum_required(VERSION 3.25)
set(prefix ${SCRATCH}/installed)
file(REMOVE_RECURSE ${SCRATCH})

function(run)
  execute_process(COMMAND ${ARGN} COMMAND_ECHO STDOUT COMMAND_ERROR_IS_FATAL ANY)
endfunction()

run(${CMAKE_COMMAND} --install ${BUILD} --component client --prefix ${prefix})
file(GLOB_RECURSE installed RELATIVE ${prefix}/include/strandcast ${prefix}/include/*)
list(SORT installed)
list(SORT HEADERS)
if(NOT installed STREQUAL HEADERS)
  message(FATAL_ERROR "installed headers: ${installed}\npublic headers: ${HEADERS}")
endif()

run(${CMAKE_COMMAND} -S ${EXAMPLE} -B ${SCRATCH}/build -G ${GENERATOR} -D CMAKE_CXX_COMPILER=${COMPILER}
  -D CMAKE_C_COMPILER=${C_COMPILER} -D CMAKE_PREFIX_PATH=${prefix})
run(${CMAKE_COMMAND} --build ${SCRATCH}/build)
run(${SCRATCH}/build/reader --help)
