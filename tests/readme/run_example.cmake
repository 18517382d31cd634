# Compiles the README's program of the core with warnings as errors, and runs it.
set(PATTERN "pvtBuildOccluder")
set(OUTPUT ${FOLDER}/example.c)
include(${CMAKE_CURRENT_LIST_DIR}/extract.cmake)
execute_process(
    COMMAND ${COMPILER} -std=c17 -Wall -Wextra -Werror -pedantic -I${INCLUDE} ${FOLDER}/example.c
            ${LIBRARY} -lm -pthread -o ${FOLDER}/example
    COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${FOLDER}/example OUTPUT_VARIABLE TEXT COMMAND_ERROR_IS_FATAL ANY)
if(NOT TEXT MATCHES "^([1-9]|1[0-2]) triangles\n$")
    message(FATAL_ERROR "the example made no occluder of 1 to 12 triangles, but said: ${TEXT}")
endif()
