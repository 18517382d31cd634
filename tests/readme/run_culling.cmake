# An occluder of a boulder hides what is behind it, and nothing in front.
execute_process(
    COMMAND ${PARAVENT} generate ${MODEL} -o ${OCCLUDER} --resolution 32 --budget 12 --effort fast
    ERROR_QUIET COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${CULLING} ${OCCLUDER} OUTPUT_VARIABLE TEXT COMMAND_ERROR_IS_FATAL ANY)
if(NOT TEXT STREQUAL "a box at z = -3 is hidden\na box at z = 3 is visible\n")
    message(FATAL_ERROR "the example said: ${TEXT}")
endif()
execute_process(COMMAND ${CULLING} ${OCCLUDER}.not ERROR_QUIET RESULT_VARIABLE CODE)
if(NOT CODE EQUAL 1)
    message(FATAL_ERROR "the example took a file that is not there")
endif()
