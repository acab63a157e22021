# strandcast_build_commit(TARGET): gives TARGET the function buildCommit() of bench/build_commit.h. The commit is asked for at
# every build, but its file is written, and compiled, only when it has changed. "unknown" outside a git checkout; a trailing +
# says that sources were changed since.
function(strandcast_build_commit target)
  set(file ${CMAKE_CURRENT_BINARY_DIR}/build_commit.cc)
  add_custom_target(${target}_commit
    COMMAND ${CMAKE_COMMAND} -DROOT=${PROJECT_SOURCE_DIR} -DOUT=${file} -P ${PROJECT_SOURCE_DIR}/cmake/BuildCommitScript.cmake
    BYPRODUCTS ${file}
    VERBATIM)
  target_sources(${target} PRIVATE ${file})
  add_dependencies(${target} ${target}_commit)
endfunction()
