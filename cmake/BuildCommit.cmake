# strandcast_build_commit(TARGET): adds the function buildCommit() of bench/machine.h to TARGET. Every build asks git for
# the commit; the source file is rewritten and compiled only if it has changed. The function returns "unknown" outside a git
# checkout; a trailing + means uncommitted changes.
function(strandcast_build_commit target)
  set(file ${CMAKE_CURRENT_BINARY_DIR}/build_commit.cc)
  add_custom_target(${target}_commit
    COMMAND ${CMAKE_COMMAND} -DROOT=${PROJECT_SOURCE_DIR} -DOUT=${file} -P ${PROJECT_SOURCE_DIR}/cmake/BuildCommitScript.cmake
    BYPRODUCTS ${file}
    VERBATIM)
  target_sources(${target} PRIVATE ${file})
  add_dependencies(${target} ${target}_commit)
endfunction()
