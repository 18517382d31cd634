# Installs a build tree, then moves the result: an installed tree must not care where it lies.
file(REMOVE_RECURSE ${PREFIX} ${PREFIX}-before)
execute_process(
    COMMAND ${CMAKE_COMMAND} --install ${BUILD} --config ${CONFIG} --prefix ${PREFIX}-before
    OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
file(RENAME ${PREFIX}-before ${PREFIX})

# Nothing in it may name the folders that it was built from.
file(GLOB_RECURSE PVT_TEXTS ${PREFIX}/*.cmake ${PREFIX}/*.pc ${PREFIX}/*.h)
foreach(PVT_TEXT IN LISTS PVT_TEXTS)
    file(STRINGS ${PVT_TEXT} PVT_LINES REGEX "${BUILD}|${PREFIX}")
    if(PVT_LINES)
        message(FATAL_ERROR "${PVT_TEXT} names a build folder: ${PVT_LINES}")
    endif()
endforeach()
